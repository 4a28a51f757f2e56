// A component of a module and the text of its interfaces: node make_component.mjs JCO MODULE WIT WORLD
// COMPONENT, where JCO is the command. (`jco embed` itself reads no file in some versions.)
import { readFileSync, realpathSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname } from 'node:path';
import { pathToFileURL } from 'node:url';

const [command, module, wit, world, target] = process.argv.slice(2);
const paths = [dirname(realpathSync(command)), dirname(command)];
const jco = createRequire(import.meta.url).resolve('@bytecodealliance/jco', { paths });
const { componentEmbed, componentNew } = await import(pathToFileURL(jco));
const binary = readFileSync(module);
const typed = await componentEmbed({ binary, witSource: readFileSync(wit, 'utf8'), world });
writeFileSync(target, await componentNew(typed, []));
