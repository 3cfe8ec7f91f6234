// A depth image as a surface: a vertex per pixel, two triangles between four.

// Neighbours whose depths differ by more than this share lie on different surfaces.
const JUMP = 1.05;

// Returns the normal of each pixel in camera axes, towards the camera, from planes of inverse depth
// over neighbours on both sides; zero where there are none.
function normalsOfDepth(depth, image) {
  const {width, height} = image, [fx, fy, cx, cy] = image.intrinsics;
  const normals = new Float32Array(3 * depth.length), reach = image.step > 1 ? 1 : 3;
  for (let v = 0, k = 0; v < height; ++v) {
    for (let u = 0; u < width; ++u, ++k) {
      if (!(depth[k] > 0)) continue;
      const q = 1 / depth[k];
      let gu = 0, su = 0, gv = 0, sv = 0;
      for (let d = 1; d <= reach; ++d) {
        for (let e = -reach; e <= reach; e += reach) {
          if (u >= d && u + d < width && v + e >= 0 && v + e < height) {
            const a = depth[k - d + e * width], b = depth[k + d + e * width];
            if (a > 0 && b > 0 && Math.abs(a * q - 1) < 0.06 && Math.abs(b * q - 1) < 0.06)
              gu += d * (1 / b - 1 / a), su += 2 * d * d;
          }
          if (v >= d && v + d < height && u + e >= 0 && u + e < width) {
            const a = depth[k - d * width + e], b = depth[k + d * width + e];
            if (a > 0 && b > 0 && Math.abs(a * q - 1) < 0.06 && Math.abs(b * q - 1) < 0.06)
              gv += d * (1 / b - 1 / a), sv += 2 * d * d;
          }
        }
      }
      if (!su || !sv) continue;
      const x = fx * gu / su, y = fy * gv / sv;
      const z = q - x * (u - cx) / fx - y * (v - cy) / fy, length = Math.hypot(x, y, z);
      normals[3 * k] = -x / length, normals[3 * k + 1] = -y / length, normals[3 * k + 2] = -z / length;
    }
  }
  return normals;
}

// Returns camera coordinates and normals of each pixel.
function verticesOfDepth(depth, image) {
  const [fx, fy, cx, cy] = image.intrinsics, positions = new Float32Array(3 * depth.length);
  for (let v = 0, k = 0; v < image.height; ++v)
    for (let u = 0; u < image.width; ++u, ++k) {
      positions[3 * k] = (u - cx) / fx * depth[k];
      positions[3 * k + 1] = (v - cy) / fy * depth[k];
      positions[3 * k + 2] = depth[k];
    }
  return {positions, normals: image.normals ? decodeNormals(image.normals) : normalsOfDepth(depth, image)};
}

// Returns every n-th pixel each way as an image of its own, of about `most` pixels.
function thinned(depth, image, most) {
  const n = Math.max(1, Math.round(Math.sqrt(depth.length / most)));
  const width = Math.ceil(image.width / n), height = Math.ceil(image.height / n), fewer = new Float32Array(width * height);
  for (let v = 0, k = 0; v < height; ++v) for (let u = 0; u < width; ++u, ++k) fewer[k] = depth[n * v * image.width + n * u];
  return {depth: fewer, image: {width, height, step: n * image.step, intrinsics: image.intrinsics.map(x => x / n)}};
}

// Returns corners of the triangles between pixels: of the surface, and of the curtains that hang from
// its edges to what is seen behind them, which nobody has seen.
function trianglesOfDepth(depth, {width, height, step}) {
  const all = new Uint32Array(6 * width * height), curtain = [], jump = 1 + (JUMP - 1) * Math.min(step, 3);
  let count = 0;
  const add = (a, b, c) => {
    const x = depth[a], y = depth[b], z = depth[c];
    if (!(x > 0 && y > 0 && z > 0)) return;
    if (Math.max(x, y, z) > jump * Math.min(x, y, z)) curtain.push(a, b, c);
    else all[count] = a, all[count + 1] = b, all[count + 2] = c, count += 3;
  };
  for (let v = 0; v + 1 < height; ++v)
    for (let u = 0; u + 1 < width; ++u) {
      const a = v * width + u, b = a + 1, c = a + width, d = c + 1;
      add(a, c, b), add(b, c, d);
    }
  return {surface: all.subarray(0, count), curtain: new Uint32Array(curtain)};
}

// Returns depth in 16 bits of two bytes, low first, as a texture that every device can read.
function textureOfDepth(depth, image) {
  const bytes = new Uint8Array(4 * depth.length), size = (image.high - image.low) / 65534;
  for (let k = 0; k < depth.length; ++k) {
    const step = depth[k] > 0 ? 1 + Math.round((depth[k] - image.low) / (size || 1)) : 0;
    bytes[4 * k] = step & 255, bytes[4 * k + 1] = step >> 8;
  }
  const texture = new THREE.DataTexture(bytes, image.width, image.height, THREE.RGBAFormat);
  texture.needsUpdate = true;
  return texture;
}
