// Each layer of the document becomes objects of the scene:
// {name, type, count, on, object, swatch, atStep(step)}.

const VIRIDIS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
function viridis(t) {
  const at = Math.min(Math.max(t, 0), 1) * (VIRIDIS.length - 1), k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[k].map((c, i) => c + (at - k) * (VIRIDIS[k + 1][i] - c));
}

function matrixOf(pose, at) {
  return new THREE.Matrix4().compose(
    new THREE.Vector3(pose[at], pose[at + 1], pose[at + 2]),
    new THREE.Quaternion(pose[at + 3], pose[at + 4], pose[at + 5], pose[at + 6]).normalize(),
    new THREE.Vector3(1, 1, 1));
}

function geometryOf(positions, normals, indices) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  if (normals) geometry.setAttribute('normal', new THREE.BufferAttribute(normals, 3));
  if (indices) geometry.setIndex(new THREE.BufferAttribute(indices, 1));
  return geometry;
}

function placed(object, order) {
  object.frustumCulled = false;
  object.renderOrder = order || 0;
  return object;
}

// A body: what moves together. `matrix` places it at the step in hand.
function makeBodies(doc) {
  return doc.bodies.map(body => {
    const poses = decode(body.poses), group = new THREE.Group();
    group.matrixAutoUpdate = false;
    return {
      name: body.name, radius: body.radius, center: new THREE.Vector3(...body.center), poses, group,
      atStep(step) {
        group.matrix.copy(matrixOf(poses, 7 * Math.min(step, poses.length / 7 - 1)));
        group.matrixWorldNeedsUpdate = true;
      },
      centerAt(step) { return this.center.clone().applyMatrix4(matrixOf(poses, 7 * Math.min(step, poses.length / 7 - 1))); },
    };
  });
}

// Measured surface, its points, and what hangs behind its edges.
function imageLayers(layer) {
  const ofStep = layer.of_step ? decode(layer.of_step) : null;
  const group = new THREE.Group(), points = new THREE.Group(), hidden = new THREE.Group(), frusta = new THREE.Group();
  const material = surfaceMaterial({byNormal: layer.by === 'normal'});
  const pointMaterial = surfaceMaterial({byNormal: layer.by === 'normal', color: '#5c7fa6'});
  const curtainMaterial = solidMaterial('#3a3a44', 0.35);
  const sheet = placed(new THREE.Mesh(geometryOf(new Float32Array(12), null, new Uint32Array([0, 1, 2, 2, 1, 3])), sheetMaterial()), 4);
  const shown = {current: -1, coarse: false, image: null, toWorld: new THREE.Matrix4(), cache: new Map()};

  // What an image becomes is made when it is first shown.
  function made(index) {
    if (shown.cache.has(index)) return shown.cache.get(index);
    const image = layer.images[index], depth = decodeDepth(image), parts = {};
    const once = (name, make) => parts[name] || (parts[name] = make());
    const vertices = () => once('vertices', () => {
      const {positions, normals} = verticesOfDepth(depth, image);
      return {position: new THREE.BufferAttribute(positions, 3), normal: new THREE.BufferAttribute(normals, 3)};
    });
    const triangles = () => once('triangles', () => trianglesOfDepth(depth, image));
    const share = indices => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', vertices().position), geometry.setAttribute('normal', vertices().normal);
      geometry.setIndex(new THREE.BufferAttribute(indices, 1));
      return geometry;
    };
    let count = 0;
    for (const d of depth) count += d > 0;
    const result = {
      image, count,
      fine: () => once('fine', () => share(triangles().surface)),
      coarse: () => once('coarse', () => {
        const small = thinned(depth, image, 12000), {positions, normals} = verticesOfDepth(small.depth, small.image);
        return geometryOf(positions, normals, trianglesOfDepth(small.depth, small.image).surface);
      }),
      curtain: () => once('curtain', () => share(triangles().curtain)),
      points: () => once('points', () => share(Uint32Array.from(depth.keys()).filter(k => depth[k] > 0))),
      texture: () => once('texture', () => textureOfDepth(depth, image)),
    };
    if (shown.cache.size > 8) shown.cache.delete(shown.cache.keys().next().value);
    shown.cache.set(index, result);
    return result;
  }

  const mesh = placed(new THREE.Mesh(undefined, material), 2), cloud = placed(new THREE.Points(undefined, pointMaterial), 1);
  const curtain = placed(new THREE.Mesh(undefined, curtainMaterial), 3);
  const frustum = placed(new THREE.LineSegments(new THREE.BufferGeometry(), lineMaterial('#22303c', 0.8)), 1);
  group.add(mesh), points.add(cloud), hidden.add(curtain, sheet), frusta.add(frustum);
  for (const object of [mesh, cloud, curtain, frustum]) object.matrixAutoUpdate = false;

  // Gives the objects that are switched on their shapes.
  function fill() {
    const it = shown.made;
    if (own.on) mesh.geometry = shown.coarse ? it.coarse() : it.fine();
    if (cloudLayer.on) cloud.geometry = it.points();
    if (!hiddenLayer.on) return;
    curtain.geometry = it.curtain();
    sheet.material.uniforms.depth.value = it.texture();
  }
  function show(index) {
    if (index === shown.current) return;
    shown.current = index;
    const it = shown.made = made(index), {image} = it;
    shown.image = image;
    shown.toWorld = matrixOf(image.pose, 0);
    frustum.geometry = frustumOf(image);
    for (const object of [mesh, cloud, curtain, frustum]) object.matrix.copy(shown.toWorld), object.matrixWorldNeedsUpdate = true;
    const uniforms = sheet.material.uniforms;
    uniforms.toCamera.value.getInverse(shown.toWorld);
    uniforms.lens.value.set(...image.intrinsics);
    uniforms.size.value.set(image.width, image.height);
    uniforms.range.value.set(image.low, image.high);
    own.count = cloudLayer.count = it.count;
  }
  const own = {
    name: layer.name, type: 'surface', count: 0, on: true, object: group, swatch: {color: '#8fa9c4'}, shown, material, mesh, sheet,
    opacity: material.uniforms.opacity, fill,
    atStep(step) { show(ofStep ? ofStep[Math.min(step, ofStep.length - 1)] : 0); },
    setCoarse(coarse) { shown.coarse = coarse; },
  };
  const cloudLayer = {name: layer.name.replace('surface', 'points'), type: 'points', count: 0, on: false, object: points, swatch: {color: '#5c7fa6'}, material: pointMaterial};
  const hiddenLayer = {name: 'not seen by the camera', type: 'unseen', on: false, object: hidden, swatch: {color: '#3a3a44'},
    legend: [['hidden behind the surface', '#3a3a44'], ['not measured', null, 'hatch'], ['seen free', '#bfe1f2']]};
  const frustumLayer = {name: 'camera', type: 'camera', on: true, object: frusta, swatch: {color: '#22303c', shape: 'line'}};
  shown.coarse = true;  // for the first picture
  own.atStep(0);
  return [own, cloudLayer, hiddenLayer, frustumLayer];
}

// The camera's pyramid to a quarter of the median depth, with a mark at its upper edge.
function frustumOf(image) {
  const [fx, fy, cx, cy] = image.intrinsics, z = 0.25 * image.median, far = image.median;
  const corner = (u, v, at) => [(u - cx) / fx * at, (v - cy) / fy * at, at];
  const w = image.width - 0.5, h = image.height - 0.5, corners = [[-0.5, -0.5], [w, -0.5], [w, h], [-0.5, h]];
  const lines = [];
  corners.forEach(([u, v], k) => {
    const [next, after] = corners[(k + 1) % 4];
    lines.push(0, 0, 0, ...corner(u, v, z), ...corner(u, v, z), ...corner(next, after, z));
  });
  const middle = 0.5 * (w - 0.5);
  lines.push(...corner(middle - 0.12 * w, -0.5, z), ...corner(middle, -0.12 * h, z), ...corner(middle, -0.12 * h, z), ...corner(middle + 0.12 * w, -0.5, z));
  return geometryOf(new Float32Array(lines));
}

function pointLayers(layer) {
  const positions = decodePositions(layer.positions), material = surfaceMaterial({byNormal: layer.by === 'normal', color: '#5c7fa6'});
  const normals = layer.normals ? decodeNormals(layer.normals) : new Float32Array(positions.length);
  const object = placed(new THREE.Points(geometryOf(positions, normals), material), 1);
  return [{name: layer.name, type: 'points', count: positions.length / 3, on: true, object, swatch: {color: '#5c7fa6'}, material, positions}];
}

function meshLayers(layer) {
  const object = placed(new THREE.Mesh(geometryOf(decodePositions(layer.positions), null, decode(layer.indices)), solidMaterial(layer.color, layer.opacity)), layer.opacity < 1 ? 5 : 0);
  return [{name: layer.name, type: 'mesh', body: layer.body, count: decode(layer.indices).length / 3, on: layer.on, object, swatch: {color: layer.color}, opacity: object.material.uniforms.opacity, step: layer.step}];
}

function sphereLayers(layer, colors) {
  const centers = decodePositions(layer.centers), radii = decode(layer.radii), count = radii.length;
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 1, -1, 0, -1, 1, 0, 1, 1, 0]), 3));
  geometry.setIndex([0, 1, 2, 2, 1, 3]);
  const sphere = new Float32Array(4 * count), tint = new Uint8Array(3 * count), state = new Uint8Array(count);
  for (let k = 0; k < count; ++k) sphere.set([centers[3 * k], centers[3 * k + 1], centers[3 * k + 2], radii[k]], 4 * k);
  geometry.setAttribute('sphere', new THREE.InstancedBufferAttribute(sphere, 4));
  const tints = new THREE.InstancedBufferAttribute(tint, 3, true), states = new THREE.InstancedBufferAttribute(state, 1);
  geometry.setAttribute('tint', tints), geometry.setAttribute('state', states);
  const object = placed(new THREE.Mesh(geometry, sphereMaterial()), 0);
  const own = {name: layer.name, type: 'spheres', body: layer.body, count, on: layer.on, object, sphere, centers, radii, step: layer.step, prefix: layer.prefix, tints, cellsOf: layer.cells};
  if (layer.states) {
    const bits = decode(layer.states), names = ['outside', 'boundary', 'inside'];
    const rgb = names.map(name => new THREE.Color(colors[name]).toArray().map(c => Math.round(255 * c)));
    own.states = state;
    own.legend = names.map((name, k) => [name, colors[name], 'ball', k]);
    own.shown = object.material.uniforms.shownStates.value;
    own.counts = [0, 0, 0, 0];  // the last: beyond the level that a step used
    own.atStep = step => {
      statesOfStep(bits, count, step, state);
      own.counts.fill(0);
      for (let k = 0; k < count; ++k) ++own.counts[state[k]], tint.set(rgb[state[k] % 3], 3 * k);
      tints.needsUpdate = states.needsUpdate = true;
    };
  } else {
    const smallest = Math.min(radii[count - 1], radii[0]), largest = Math.max(radii[0], radii[count - 1]);
    for (let k = 0; k < count; ++k) tint.set(viridis(largest > smallest ? Math.log(radii[k] / smallest) / Math.log(largest / smallest) : 1), 3 * k);
    own.key = {name: 'radius', unit: 'm', low: smallest, high: largest};
  }
  own.swatch = {color: layer.states ? colors.boundary : '#21918c', shape: 'ball'};
  let most = count, prefix = count;  // the largest spheres are first
  const restrict = () => { geometry.maxInstancedCount = Math.min(most, prefix); };
  own.setCoarse = coarse => { most = coarse ? 2000 : count; restrict(); };
  if (layer.prefix) own.atStep = step => { prefix = Math.min(step + 1, count); restrict(); };
  return [own];
}

function lineLayers(layer) {
  const positions = decodePositions(layer.positions);
  const object = placed(new THREE.LineSegments(geometryOf(positions), lineMaterial(layer.color)), 6);
  if (layer.above) object.material.depthTest = false;
  const marks = layer.marks ? placed(new THREE.Points(geometryOf(positions), new THREE.PointsMaterial({color: layer.color, size: 5, sizeAttenuation: false, depthTest: !layer.above})), 6) : null;
  const group = new THREE.Group();
  group.add(object);
  if (marks) group.add(marks);
  return [{name: layer.name, type: 'lines', body: layer.body, count: layer.count, on: layer.on, object: group, swatch: {color: layer.color, shape: 'line'}, step: layer.step}];
}

// Points that are shown until a slider has come to their number.
function dustLayers(layer) {
  const geometry = geometryOf(decodePositions(layer.positions)), until = Float32Array.from(decode(layer.until));
  geometry.setAttribute('until', new THREE.BufferAttribute(until, 1));
  const material = new THREE.ShaderMaterial({
    uniforms: {color: {value: new THREE.Color(layer.color)}, step: {value: 0}, size: {value: 2.5}},
    vertexShader: 'attribute float until; uniform float step, size; void main() { gl_PointSize = size; gl_Position = until > step ? projectionMatrix * modelViewMatrix * vec4(position, 1.0) : vec4(2.0, 2.0, 2.0, 1.0); }',
    fragmentShader: 'uniform vec3 color; void main() { gl_FragColor = vec4(color, 1.0); }',
  });
  const own = {name: layer.name, type: 'dust', on: layer.on, object: placed(new THREE.Points(geometry, material), 1), swatch: {color: layer.color}};
  own.atStep = step => {
    material.uniforms.step.value = step;
    own.count = until.reduce((n, k) => n + (k > step), 0);
  };
  return [own];
}

function pathLayers(layer, bodies) {
  const {poses, center} = bodies[layer.body], count = poses.length / 7, positions = new Float32Array(3 * count);
  for (let k = 0; k < count; ++k) center.clone().applyMatrix4(matrixOf(poses, 7 * k)).toArray(positions, 3 * k);
  const group = new THREE.Group();
  group.add(placed(new THREE.Line(geometryOf(positions), lineMaterial(layer.color)), 6),
    placed(new THREE.Points(geometryOf(positions), new THREE.PointsMaterial({color: layer.color, size: 3, sizeAttenuation: false})), 6));
  group.children.forEach(child => { child.material.depthTest = false; child.material.transparent = true; child.material.opacity = 0.55; });
  return [{name: layer.name, type: 'path', count, on: layer.on, object: group, swatch: {color: layer.color, shape: 'line'}}];
}

// An arrow at the body's centre of mass, in world axes; the longest of all steps is 1.4 body radii.
function arrowLayers(layer, bodies, columns) {
  const body = bodies[layer.body], values = columns[layer.column].values, material = solidMaterial(layer.color, 1);
  material.depthTest = false;
  const thick = 0.025 * body.radius, shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(thick, thick, 1, 12).translate(0, 0.5, 0), material);
  const heads = [0, 1].slice(0, layer.ring ? 2 : 1).map(() => new THREE.Mesh(new THREE.ConeBufferGeometry(3 * thick, 8 * thick, 16).translate(0, -4 * thick, 0), material));
  const group = new THREE.Group(), turned = new THREE.Group();
  turned.add(shaft, ...heads);
  if (layer.ring) turned.add(new THREE.Mesh(new THREE.TorusBufferGeometry(0.18 * body.radius, thick, 8, 32, 1.6 * Math.PI).rotateX(Math.PI / 2), material));
  turned.children.forEach(child => placed(child, 8));
  group.add(turned);
  let largest = 0;
  for (let k = 0; k < values.length; k += 3) largest = Math.max(largest, Math.hypot(values[k], values[k + 1], values[k + 2]));
  return [{
    name: layer.name, type: 'arrow', on: layer.on, object: group, swatch: {color: layer.color, shape: 'line'},
    atStep(step) {
      const along = new THREE.Vector3(values[3 * step], values[3 * step + 1], values[3 * step + 2]), size = along.length();
      turned.visible = size > 0;
      if (!(size > 0)) return;
      const length = Math.max(1.4 * body.radius * size / largest, 8 * thick);
      turned.position.copy(body.centerAt(step));
      turned.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.divideScalar(size));
      shaft.scale.y = Math.max(length - 6 * thick, 1e-9);
      heads.forEach((head, k) => head.position.set(0, length - 5 * thick * k, 0));
    },
  }];
}

const MAKERS = {
  image: imageLayers, points: pointLayers, mesh: meshLayers, lines: lineLayers, dust: dustLayers,
};
function makeLayers(doc, bodies, columns) {
  const layers = [];
  for (const layer of doc.layers) {
    layers.push(...(layer.type === 'spheres' ? sphereLayers(layer, doc.colors) :
      layer.type === 'path' ? pathLayers(layer, bodies) :
      layer.type === 'arrow' ? arrowLayers(layer, bodies, columns) : MAKERS[layer.type](layer)));
  }
  return layers;
}
