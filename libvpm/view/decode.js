// Numbers as the tools pack them: little-endian arrays in base64.
const ARRAYS = {u8: Uint8Array, u16: Uint16Array, u32: Uint32Array, f32: Float32Array};

function decode(packed) {
  const text = atob(packed.data);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  return new ARRAYS[packed.type](bytes.buffer);
}

// Returns x, y, z of each place, metres about the page's origin.
function decodePositions(packed) {
  const steps = decode(packed.steps), positions = new Float32Array(steps.length);
  for (let k = 0; k < steps.length; ++k)
    positions[k] = packed.low[k % 3] + packed.size[k % 3] * steps[k] / 65535;
  return positions;
}

// Returns unit vectors from their octahedral maps, two bytes each; zero for 0, 0.
function decodeNormals(packed) {
  const bytes = decode(packed), normals = new Float32Array(bytes.length / 2 * 3);
  for (let k = 0, n = 0; k < bytes.length; k += 2, n += 3) {
    if (bytes[k] === 0) continue;
    let x = (bytes[k] - 128) / 127, y = (bytes[k + 1] - 128) / 127;
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
    const length = Math.hypot(x, y, z);
    normals[n] = x / length, normals[n + 1] = y / length, normals[n + 2] = z / length;
  }
  return normals;
}

// Returns depths in metres, 0 where nothing was measured.
function decodeDepth(image) {
  const steps = decode(image.depth), depth = new Float32Array(steps.length);
  const size = (image.high - image.low) / 65534;
  for (let k = 0; k < steps.length; ++k) depth[k] = steps[k] ? image.low + (steps[k] - 1) * size : 0;
  return depth;
}

// Returns the states of one step: two bits per sphere, the first sphere in the lowest bits.
function statesOfStep(bits, count, step, states) {
  const row = Math.ceil(count / 4);
  for (let k = 0; k < count; ++k) states[k] = bits[row * step + (k >> 2)] >> 2 * (k & 3) & 3;
  return states;
}

// A unit for all values of a column, so that it does not change from step to step.
const SCALES = {
  m: [[1, 'm'], [1e-3, 'mm'], [1e-6, 'µm']],
  m3: [[1, 'm³'], [1e-6, 'cm³'], [1e-9, 'mm³']],
  m4: [[1, 'm⁴'], [1e-8, 'cm⁴'], [1e-12, 'mm⁴']],
  N: [[1e3, 'kN'], [1, 'N'], [1e-3, 'mN'], [1e-6, 'µN']],
  Nm: [[1e3, 'kN m'], [1, 'N m'], [1e-3, 'mN m'], [1e-6, 'µN m']],
};
function scaleFor(unit, values) {
  let largest = 0;
  for (const value of values) largest = Math.max(largest, Math.abs(value));
  const scales = SCALES[unit] || [[1, unit]];
  return scales.find(([size]) => largest >= size) || (largest > 0 ? scales[scales.length - 1] : scales[Math.min(1, scales.length - 1)]);
}
function digits(value) {
  if (value === 0 || !isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) return value.toExponential(2);
  return size >= 1000 ? value.toFixed(0) : value.toPrecision(size >= 1 ? 4 : 3);
}
