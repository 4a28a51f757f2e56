// The implicit step of `model/step/step.py` for LANES machines at once, one in each lane of vectors:
// linear part by a band, the contacts of two journals by Newton's method, until all lanes have
// converged. Every lane has its own step length, speed, clearance, friction and unbalance; mass,
// damping, stiffness and gyroscopic matrices are those of all.

typedef double V __attribute__((vector_size(8 * LANES)));
typedef long long Mask __attribute__((vector_size(8 * LANES)));

struct Cx { V re, im; };

static inline V all(double x) { return V{} + x; }
static inline V pick(Mask m, V a, V b) { return (V)((m & (Mask)a) | (~m & (Mask)b)); }
static inline V root(V x) { return __builtin_elementwise_sqrt(x); }
static inline V size(V x) { return __builtin_elementwise_abs(x); }
static inline V larger(V a, V b) { return pick(a > b, a, b); }
static inline V smaller(V a, V b) { return pick(a < b, a, b); }
static inline Cx operator+(Cx a, Cx b) { return {a.re + b.re, a.im + b.im}; }
static inline Cx operator-(Cx a, Cx b) { return {a.re - b.re, a.im - b.im}; }
static inline Cx operator*(Cx a, Cx b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
static inline Cx operator*(V a, Cx b) { return {a * b.re, a * b.im}; }
static inline Cx operator*(double a, Cx b) { return {a * b.re, a * b.im}; }
static inline Cx conj(Cx a) { return {a.re, -a.im}; }
static inline Cx pick(Mask m, Cx a, Cx b) { return {pick(m, a.re, b.re), pick(m, a.im, b.im)}; }
static inline V modulus(Cx a) { return root(a.re * a.re + a.im * a.im); }
static inline bool any(Mask m) {
  long long found = 0;
  for (int l = 0; l < LANES; l++) found |= m[l];
  return found != 0;
}

enum { MOST = 64, WIDTH = 8, CONTACTS = 2, NEWTON = 20, STARTS = 3 };

struct Machine {  // what all lanes share
  long long n, width, unbalances;
  double *M, *C, *K, *G, *weight;  // bands (n, width); weight on the imaginary axis (n)
  long long *unbalance_dof, *contact_dof;
  double housing[5];  // mass, kx, ky, cx, cy
  double contact[5];  // k, c, delta_c, v_s, journal radius
  double scheme[4];   // alpha_m, alpha_f, beta, gamma
  double g;
};

struct Lanes {  // what each has for itself
  V h, omega, clearance, mu;
  Cx turned, turn;  // exp(i theta), and by how much a step turns it
  Cx unbalance[8];
  Cx q[MOST], v[MOST], a[MOST], v_dot[MOST], force[CONTACTS];
  V iterations, failed;  // Newton's, those of all lanes that waited included; steps not solved
};

static void add_product(const Machine &s, const double *band, const Cx *x, Cx *y) {
  for (int i = 0; i < s.n; i++) y[i] = y[i] + band[i * s.width] * x[i];
  for (int d = 1; d < s.width; d++) {
    for (int i = 0; i < s.n - d; i++) y[i] = y[i] + band[i * s.width + d] * x[i + d];
    for (int i = 0; i < s.n - d; i++) y[i + d] = y[i + d] + band[i * s.width + d] * x[i];
  }
}

static void factorize(int n, int width, Cx (*f)[WIDTH]) {
  for (int j = 0; j < n; j++) {
    Cx pivot = f[j][0];
    Cx inverse = (1.0 / (pivot.re * pivot.re + pivot.im * pivot.im)) * conj(pivot);
    int last = width < n - j ? width : n - j;
    for (int d = 1; d < last; d++) {
      Cx ratio = f[j][d] * inverse;
      for (int e = d; e < last; e++) f[j + d][e - d] = f[j + d][e - d] - ratio * f[j][e];
      f[j][d] = ratio;
    }
    f[j][0] = inverse;
  }
}

static void solve(int n, int width, Cx (*f)[WIDTH], Cx *x, int first) {
  for (int j = first; j < n; j++) {
    int last = width < n - j ? width : n - j;
    for (int d = 1; d < last; d++) x[j + d] = x[j + d] - f[j][d] * x[j];
  }
  for (int j = n - 1; j >= 0; j--) {
    int last = width < n - j ? width : n - j;
    Cx total = f[j][0] * x[j];
    for (int d = 1; d < last; d++) total = total - f[j][d] * x[j + d];
    x[j] = total;
  }
}

// Elimination; rows are exchanged where their pivot is larger, lane by lane.
static void solve_dense(V (*a)[4], V *x) {
  for (int k = 0; k < 4; k++) {
    for (int i = k + 1; i < 4; i++) {
      Mask m = size(a[i][k]) > size(a[k][k]);
      if (!any(m)) continue;
      for (int j = k; j < 4; j++) {
        V top = pick(m, a[i][j], a[k][j]);
        a[i][j] = pick(m, a[k][j], a[i][j]);
        a[k][j] = top;
      }
      V top = pick(m, x[i], x[k]);
      x[i] = pick(m, x[k], x[i]);
      x[k] = top;
    }
    V inverse = 1.0 / a[k][k];
    for (int i = k + 1; i < 4; i++) {
      V ratio = a[i][k] * inverse;
      for (int j = k + 1; j < 4; j++) a[i][j] -= ratio * a[k][j];
      x[i] -= ratio * x[k];
    }
    x[k] *= inverse;
    for (int j = k + 1; j < 4; j++) a[k][j] *= inverse;
  }
  for (int i = 3; i >= 0; i--)
    for (int j = i + 1; j < 4; j++) x[i] -= a[i][j] * x[j];
}

// Force of a contact and its tangent p, q; zero in the lanes that do not touch.
static void touch(const Machine &s, const Lanes &w, Cx d, Cx d_dot, V b_d, V b_v, Cx &force, Cx &p, Cx &q) {
  const double k = s.contact[0], c_all = s.contact[1], delta_c = s.contact[2], v_s = s.contact[3];
  V r = modulus(d), delta = r - w.clearance;
  Cx e = (1.0 / r) * d, local = conj(e) * d_dot;
  V share = smaller(all(1.0), delta / delta_c), c = c_all * share;
  V n = k * delta + c * local.re;
  V n_a = k + pick(share < 1.0, c_all / delta_c * local.re, V{});
  Mask on = (delta > 0.0) & (n > 0.0);
  V v_t = local.im + s.contact[4] * w.omega, rooted = root(v_t * v_t + v_s * v_s);
  V mu = w.mu * v_t / rooted, by_v = w.mu * (v_s * v_s) / (rooted * rooted * rooted), h_b = 1.0 / r;
  V n_b = c * local.im * h_b, slope = n * by_v;
  V aa = -b_d * n_a - b_v * c, ab = b_d * (mu * n * h_b - n_b);
  V ba = -b_d * mu * n_a - b_v * mu * c;
  V bb = b_d * (slope * local.re * h_b - mu * n_b - n * h_b) - b_v * slope;
  Cx none = {V{}, V{}};
  force = pick(on, (-n) * (Cx{all(1.0), mu} * e), none);
  p = pick(on, 0.5 * Cx{aa + bb, ba - ab}, none);
  q = pick(on, (0.5 * Cx{aa - bb, ba + ab}) * e * e, none);
}

static void step(const Machine &s, Lanes &w) {
  const int n = s.n, width = s.width;
  const double am = s.scheme[0], af = s.scheme[1], beta = s.scheme[2], gamma = s.scheme[3];
  const double share = 1.0 - af;
  V h = w.h, c_factor = share * gamma * h, k_factor = share * beta * h * h;
  V gyroscopic = -(c_factor * w.omega), b_d = beta * h * h, b_v = gamma * h;
  Cx f[MOST][WIDTH], column[CONTACTS][MOST], housing[CONTACTS];
  Cx q[MOST], v[MOST], a[MOST], scratch[MOST];
  V W[4][4];
  w.turned = w.turned * w.turn;

  // factors of the step matrix, condensed to the contacts
  for (int i = 0; i < n; i++)
    for (int d = 0; d < width; d++) {
      int at = i * width + d;
      f[i][d] = {(1.0 - am) * s.M[at] + c_factor * s.C[at] + k_factor * s.K[at], gyroscopic * s.G[at]};
    }
  factorize(n, width, f);
  for (int j = 0; j < CONTACTS; j++) {
    double inertia = (1.0 - am) * s.housing[0];
    housing[j].re = share / (inertia + c_factor * s.housing[3] + k_factor * s.housing[1]);
    housing[j].im = share / (inertia + c_factor * s.housing[4] + k_factor * s.housing[2]);
    for (int i = 0; i < n; i++) column[j][i] = {V{}, V{}};
    column[j][s.contact_dof[j]].re = all(share);
    solve(n, width, f, column[j], s.contact_dof[j]);
    for (int i = 0; i < CONTACTS; i++) {
      Cx response = column[j][s.contact_dof[i]];
      W[2 * i][2 * j] = response.re + (i == j ? housing[j].re : V{});
      W[2 * i][2 * j + 1] = -response.im;
      W[2 * i + 1][2 * j] = response.im;
      W[2 * i + 1][2 * j + 1] = response.re + (i == j ? housing[j].im : V{});
    }
  }

  // what would follow without contacts
  for (int i = 0; i < n + CONTACTS; i++) {
    q[i] = w.q[i] + h * w.v[i] + (h * h * (0.5 - beta)) * w.a[i];
    v[i] = w.v[i] + (h * (1.0 - gamma)) * w.a[i];
  }
  for (int i = 0; i < n; i++) {
    a[i] = {V{}, all(share * s.weight[i])};
    scratch[i] = af * w.v_dot[i] - am * w.a[i];
  }
  for (int i = 0; i < s.unbalances; i++) {
    Cx &at = a[s.unbalance_dof[i]];
    at = at + (share * w.omega * w.omega) * (w.unbalance[i] * w.turned);
  }
  add_product(s, s.M, scratch, a);
  for (int i = 0; i < n; i++) scratch[i] = -share * v[i];
  add_product(s, s.C, scratch, a);
  for (int i = 0; i < n; i++) scratch[i] = -share * q[i];
  add_product(s, s.K, scratch, a);
  for (int i = 0; i < n; i++) {
    Cx turned = (-share * w.omega) * v[i];
    scratch[i] = {turned.im, -turned.re};
  }
  add_product(s, s.G, scratch, a);
  solve(n, width, f, a, 0);
  for (int j = 0; j < CONTACTS; j++) {
    int at = n + j;
    Cx rest = (s.housing[0] / share) * (am * w.a[at] - af * w.v_dot[at]);
    V x = s.housing[1] * q[at].re + s.housing[3] * v[at].re + rest.re;
    V y = s.housing[2] * q[at].im + s.housing[4] * v[at].im + rest.im + s.housing[0] * s.g;
    a[at] = {-housing[j].re * x, -housing[j].im * y};
  }

  // Newton's method on the contacts' accelerations, in all lanes until the last has converged
  Cx d0[CONTACTS], d0_dot[CONTACTS], w_free[CONTACTS], z[CONTACTS], force[CONTACTS], p[CONTACTS], pq[CONTACTS];
  Mask left = ~Mask{};
  for (int start = 0; start < STARTS && any(left); start++) {
    for (int j = 0; j < CONTACTS; j++) {
      int at = s.contact_dof[j], end = n + j;
      d0[j] = q[at] - q[end];
      d0_dot[j] = v[at] - v[end];
      w_free[j] = a[at] - a[end];
      Cx begin = w_free[j];
      if (start == 0) {  // slides on at the same depth
        Cx ahead = d0[j] + b_d * (w.a[at] - w.a[end]);
        Cx there = (modulus(w.q[at] - w.q[end]) / modulus(ahead)) * ahead;
        Mask on = (w.force[j].re != 0.0) | (w.force[j].im != 0.0);
        begin = pick(on, (1.0 / b_d) * (there - d0[j]), begin);
      } else if (start == 2) {  // at the wall
        Cx free = d0[j] + b_d * begin;
        V r = modulus(free);
        begin = pick(r > w.clearance, (1.0 / b_d) * ((w.clearance / r) * free - d0[j]), begin);
      }
      z[j] = start == 0 ? begin : pick(left, begin, z[j]);
    }
    for (int i = 0; i < NEWTON && any(left); i++) {
      V J[4][4] = {}, x[4];
      Cx now[CONTACTS];
      for (int r = 0; r < 4; r++) J[r][r] = all(1.0);
      for (int j = 0; j < CONTACTS; j++) {
        x[2 * j] = w_free[j].re - z[j].re;
        x[2 * j + 1] = w_free[j].im - z[j].im;
      }
      for (int j = 0; j < CONTACTS; j++) {
        touch(s, w, d0[j] + b_d * z[j], d0_dot[j] + b_v * z[j], b_d, b_v, now[j], p[j], pq[j]);
        V xx = p[j].re + pq[j].re, yx = p[j].im + pq[j].im, xy = pq[j].im - p[j].im, yy = p[j].re - pq[j].re;
        for (int r = 0; r < 4; r++) {
          x[r] += W[r][2 * j] * now[j].re + W[r][2 * j + 1] * now[j].im;
          J[r][2 * j] -= W[r][2 * j] * xx + W[r][2 * j + 1] * yx;
          J[r][2 * j + 1] -= W[r][2 * j] * xy + W[r][2 * j + 1] * yy;
        }
      }
      solve_dense(J, x);
      Mask moved = Mask{};
      for (int j = 0; j < CONTACTS; j++) {
        Cx change = {x[2 * j], x[2 * j + 1]};
        z[j] = pick(left, z[j] + change, z[j]);
        force[j] = pick(left, now[j] + p[j] * change + pq[j] * conj(change), force[j]);
        moved |= ~(b_d * modulus(change) <= 1e-8 * w.clearance);
      }
      w.iterations += pick(left, all(1.0), V{});
      left &= moved;
    }
  }
  w.failed += pick(left, all(1.0), V{});

  const double by_new = (1.0 - am) / share, by_old = am / share, by_balance = af / share;
  for (int j = 0; j < CONTACTS; j++) {
    w.force[j] = force[j];
    for (int i = 0; i < n; i++) a[i] = a[i] + column[j][i] * force[j];
    a[n + j] = a[n + j] - Cx{housing[j].re * force[j].re, housing[j].im * force[j].im};
  }
  for (int i = 0; i < n + CONTACTS; i++) {
    w.q[i] = q[i] + b_d * a[i];
    w.v[i] = v[i] + b_v * a[i];
    w.v_dot[i] = by_new * a[i] + by_old * w.a[i] - by_balance * w.v_dot[i];
    w.a[i] = a[i];
  }
}

extern "C" long long lanes_bytes() { return sizeof(Lanes); }
extern "C" void lanes_march(const Machine *s, Lanes *w, long long steps) {
  for (long long i = 0; i < steps; i++) step(*s, *w);
}
