// Prints what three.js reads of files of points, as JSON: the coordinates and normals of each.
//
//     node three_reads.mjs FILE...
//
// Finds the package three in a folder node_modules at or above this file.
import { readFileSync } from 'node:fs';
import { PLYLoader } from 'three/examples/jsm/loaders/PLYLoader.js';
import { PCDLoader } from 'three/examples/jsm/loaders/PCDLoader.js';

const read = (name) => {
  const bytes = readFileSync(name);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const geometry = name.endsWith('.ply') ? new PLYLoader().parse(buffer) : new PCDLoader().parse(buffer, name).geometry;
  const list = (attribute) => Array.from(geometry.attributes[attribute]?.array ?? []);
  return { positions: list('position'), normals: list('normal') };
};
console.log(JSON.stringify(process.argv.slice(2).map(read)));
