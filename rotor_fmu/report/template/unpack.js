// Numbers as packed.py packs them: inflated, planes of bytes put together, differences summed up.

const bytesOf = (text) => {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
  return bytes;
};

async function unpack(pack) {
  const stream = new Blob([bytesOf(pack.data)]).stream();
  const inflated = stream.pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(inflated).arrayBuffer());
  const { n, bits, low, step } = pack;
  const top = 2 ** bits - 1;
  const counts = new Uint32Array(n);
  for (let plane = 0; plane < bits / 8; plane++) {
    for (let i = 0; i < n; i++) counts[i] |= planes[plane * n + i] << (8 * plane);
  }
  for (let times = 0; times < pack.differences; times++) {
    for (let i = 1; i < n; i++) counts[i] = (counts[i] + counts[i - 1]) & top;
  }
  const values = new Float64Array(n);
  for (let i = 0; i < n; i++) values[i] = counts[i] === top ? NaN : low + step * counts[i];
  return values;
}

// Every pack within an object, at once.
async function unpackAll(thing) {
  if (thing === null || typeof thing !== "object") return thing;
  if ("differences" in thing && "data" in thing) return unpack(thing);
  const keys = Object.keys(thing);
  const found = await Promise.all(keys.map((key) => unpackAll(thing[key])));
  if (Array.isArray(thing)) return found;
  return Object.fromEntries(keys.map((key, i) => [key, found[i]]));
}

const readData = (id) => JSON.parse(document.getElementById(id).textContent);

// Index of the entry of a list that is nearest to a value.
function nearest(list, value) {
  let best = 0;
  for (let i = 1; i < list.length; i++) {
    if (Math.abs(list[i] - value) < Math.abs(list[best] - value)) best = i;
  }
  return best;
}

// Of a list that grows.
function nearestSorted(list, value) {
  let low = 0;
  let high = list.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] <= value) low = middle;
    else high = middle;
  }
  return Math.abs(list[high] - value) < Math.abs(list[low] - value) ? high : low;
}

// As a person reads it: five digits.
const shown = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(5))) : "-");
