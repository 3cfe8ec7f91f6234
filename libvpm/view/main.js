// Puts scene and panel together: steps, points of view, drawing.

const started = performance.now(), faults = [];
window.addEventListener('error', event => faults.push(event.message));

const doc = JSON.parse(document.getElementById('data').textContent);
showFacts(doc);
const canvas = document.getElementById('scene');
// Smooth edges take a processor that draws without a graphics card four times as long.
function drawsBySoftware() {
  const probe = document.createElement('canvas').getContext('webgl2');
  const info = probe && probe.getExtension('WEBGL_debug_renderer_info');
  return Boolean(info) && /swiftshader|llvmpipe|software/i.test(probe.getParameter(info.UNMASKED_RENDERER_WEBGL));
}
const bySoftware = drawsBySoftware(), context = canvas.getContext('webgl2', {antialias: !bySoftware, alpha: true});
if (!context) {
  const fault = document.getElementById('fault');
  fault.hidden = false;
  fault.textContent = 'This browser draws no WebGL 2: open the file in a newer one, or switch hardware acceleration on.';
  throw new Error('no WebGL 2');
}
const renderer = new THREE.WebGLRenderer({canvas, context, alpha: true});
const scene = new THREE.Scene(), up = new THREE.Vector3(...doc.up);
const camera = new THREE.PerspectiveCamera(45, 1, 0.01, 100);
camera.up.copy(up);
const controls = new THREE.OrbitControls(camera, canvas);
controls.enableKeys = false;
controls.screenSpacePanning = true;
controls.maxPolarAngle = Math.PI;

const columns = doc.columns.map(column => ({...column, values: decode(column.values)}));
for (const column of columns) column.scale = scaleFor(column.unit, column.values);
const bodies = makeBodies(doc), layers = makeLayers(doc, bodies, columns);
for (const body of bodies) scene.add(body.group);
for (const layer of layers) (layer.body === undefined ? scene : bodies[layer.body].group).add(layer.object);
const surfaces = layers.filter(layer => layer.type === 'surface');

// The box of what is shown, in the world; far strays of a cloud do not count.
const extent = {center: new THREE.Vector3(...doc.center), radius: doc.radius};
const focusBody = bodies[0];

const steps = doc.steps;
let step = 0, playing = null;
const showStep = showNumbers(doc, bodies, columns), cursors = [];
const slider = document.getElementById('slider'), where = document.getElementById('where');

function setStep(wanted) {
  step = Math.min(Math.max(wanted, 0), Math.max(steps.count - 1, 0));
  slider.value = step;
  where.textContent = steps.names ? steps.names[steps.name_of ? steps.nameOf[step] : step] || '' :
    steps.counts_up ? `${step + 1} of ${steps.count} ${steps.name}` : `${steps.name} ${steps.numbers ? steps.numbers[step] : step} of ${steps.last}`;
  for (const body of bodies) body.atStep(step);
  for (const layer of layers) if (layer.atStep) layer.atStep(step);
  if (focusBody) for (const layer of surfaces) {
    const center = focusBody.centerAt(step);
    layer.material.uniforms.hole.value.set(center.x, center.y, center.z, focusBody.radius);
    placeSheet(layer, center);
  }
  showStep(step);
  for (const move of cursors) move(step);
  refresh();
}
function refresh() {
  refreshLayers(layers, step);
  for (const layer of surfaces) layer.fill();
  draw();
}

// The sheet goes through the tool's centre, along the camera's sight and upwards.
function placeSheet(layer, center) {
  const eye = new THREE.Vector3().setFromMatrixPosition(layer.shown.toWorld), sight = center.clone().sub(eye), distance = sight.length() || 1;
  sight.divideScalar(distance);
  const across = up.clone().addScaledVector(sight, -up.dot(sight)).normalize(), half = Math.max(2.2 * focusBody.radius, 0.2 * distance);
  const near = Math.max(distance - 3 * focusBody.radius, 0.05 * distance), far = distance + 3 * focusBody.radius, position = layer.sheet.geometry.attributes.position;
  [[near, -half], [far, -half], [near, half], [far, half]].forEach(([z, y], k) => {
    const at = eye.clone().addScaledVector(sight, z).addScaledVector(across, y);
    position.setXYZ(k, at.x, at.y, at.z);
  });
  position.needsUpdate = true;
}

// Points of view.
function sensor() {
  const shown = surfaces.length ? surfaces[0].shown : null;
  if (!shown) return null;
  const e = shown.toWorld.elements;
  return {eye: new THREE.Vector3(e[12], e[13], e[14]), right: new THREE.Vector3(e[0], e[1], e[2]), down: new THREE.Vector3(e[4], e[5], e[6]), ahead: new THREE.Vector3(e[8], e[9], e[10]), image: shown.image};
}
function frameOfView() {
  const from = sensor();
  if (from) return from;
  const ahead = Math.abs(up.y) > 0.9 ? new THREE.Vector3(0, 0, -1) : new THREE.Vector3(0, 1, 0);
  return {eye: extent.center.clone().addScaledVector(ahead, -2.5 * extent.radius), right: new THREE.Vector3().crossVectors(ahead, up), down: up.clone().negate(), ahead};
}
function look(target, direction, radius, angle) {
  camera.fov = angle || 40;
  const narrow = Math.min(1, camera.aspect), reach = radius / Math.sin(camera.fov * narrow * Math.PI / 360);
  camera.up.copy(up);
  controls.target.copy(target);
  camera.position.copy(target).addScaledVector(direction.clone().normalize(), -reach);
  camera.updateProjectionMatrix();
  controls.update();
  draw();
}
function focus() { return focusBody ? {center: focusBody.centerAt(step), radius: focusBody.radius} : extent; }

// Where boundary and inner spheres are, in the world.
function contact() {
  const box = new THREE.Box3();
  for (const layer of layers.filter(l => l.states)) {
    const matrix = bodies[layer.body].group.matrix, pick = layer.counts[1] ? 1 : 2;
    for (let k = 0; k < layer.count; ++k) {
      if (layer.states[k] !== pick) continue;
      const at = new THREE.Vector3().fromArray(layer.centers, 3 * k).applyMatrix4(matrix), r = new THREE.Vector3().setScalar(layer.radii[k]);
      box.expandByPoint(at.clone().add(r)).expandByPoint(at.sub(r));
    }
  }
  if (box.isEmpty()) return null;
  return {center: box.getCenter(new THREE.Vector3()), radius: 0.6 * box.getSize(new THREE.Vector3()).length()};
}
const VIEWS = {
  overview() {
    const from = frameOfView(), {center, radius} = focus(), wide = focusBody && steps.moves ? 2.6 * radius : 1.25 * radius;
    look(center, from.ahead.clone().addScaledVector(from.right, -0.85).addScaledVector(from.down, 0.5), wide);
  },
  camera() {
    const from = sensor(), target = focus();
    if (!from) return VIEWS.overview();
    const ahead = Math.max(target.center.clone().sub(from.eye).dot(from.ahead), 0.2 * from.image.median);
    camera.fov = 2 * Math.atan(0.5 * from.image.height / from.image.intrinsics[1] / Math.min(1, camera.aspect * from.image.height / from.image.width)) * 180 / Math.PI;
    camera.up.copy(up);
    camera.position.copy(from.eye);
    controls.target.copy(from.eye).addScaledVector(from.ahead, ahead);
    camera.updateProjectionMatrix();
    controls.update();
    draw();
  },
  side() {
    const from = frameOfView(), {center, radius} = focus();
    look(center, from.right.clone().negate().addScaledVector(from.ahead, 0.05), 2 * radius);
  },
  contact() {
    const from = frameOfView(), at = contact() || focus();
    look(at.center, from.ahead.clone().multiplyScalar(0.35).addScaledVector(from.right, -0.9).addScaledVector(from.down, 0.3), 1.1 * at.radius);
  },
  all() {
    const from = frameOfView();
    look(extent.center, from.ahead.clone().addScaledVector(from.right, -0.6).addScaledVector(from.down, 0.4), 1.1 * extent.radius);
  },
};
function setView(name) {
  const views = document.getElementById('views');
  for (const button of views.children) button.setAttribute('aria-pressed', String(button.dataset.view === name));
  VIEWS[name]();
}
for (const name of doc.views) {
  const button = element('button', {type: 'button', textContent: name[0].toUpperCase() + name.slice(1)});
  button.dataset.view = name;
  button.addEventListener('click', () => setView(name));
  document.getElementById('views').append(button);
}
controls.addEventListener('change', draw);
controls.addEventListener('start', () => {
  moving = true;
  for (const button of document.getElementById('views').children) button.setAttribute('aria-pressed', 'false');
});
controls.addEventListener('end', () => { moving = false; slow = 0; setCoarse(false); draw(); });

// Drawing: only when something has changed. Where a frame takes long, images are drawn coarser, with
// fewer pixels and spheres, as long as they move.
let wanted = false, moving = false, lastFrame = 0, slow = 0, coarse = false, firstPicture = 0;
function setCoarse(on) {
  if (on === coarse) return;
  coarse = on;
  for (const layer of layers) if (layer.setCoarse) layer.setCoarse(on);
  fitPixels();
  refresh();
}
function draw() {
  if (wanted) return;
  wanted = true;
  requestAnimationFrame(now => {
    wanted = false;
    if (moving || playing) {
      slow = now - lastFrame > 45 ? slow + 1 : 0;
      if (slow > 2) setCoarse(true);
    }
    lastFrame = now;
    render();
    if (firstPicture) return;
    firstPicture = performance.now();
    setCoarse(false);
    draw();
  });
}
function render() {
  const size = Math.max(extent.radius, camera.position.distanceTo(extent.center));
  const distance = camera.position.distanceTo(controls.target);
  camera.near = Math.max(0.02 * distance, 1e-4 * size);
  camera.far = 4 * (size + extent.radius);
  camera.updateProjectionMatrix();
  renderer.render(scene, camera);
}
function fitPixels() {
  const {clientWidth, clientHeight} = canvas.parentElement;
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2) * (coarse && bySoftware ? 0.5 : 1));
  renderer.setSize(clientWidth, clientHeight, false);
}
function resize() {
  const {clientWidth, clientHeight} = canvas.parentElement;
  fitPixels();
  camera.aspect = clientWidth / Math.max(clientHeight, 1);
  camera.updateProjectionMatrix();
  const pointSize = Math.max(1.5, 2 * renderer.getPixelRatio());
  for (const layer of layers) if (layer.type === 'points') layer.material.uniforms.size.value = pointSize;
  draw();
}
window.addEventListener('resize', resize);

// Slider and keys.
function play(on) {
  clearInterval(playing);
  playing = on ? setInterval(() => setStep(step + stride >= steps.count ? 0 : step + stride), 1000 / 15) : null;
  const button = document.getElementById('play');
  button.textContent = on ? '❚❚' : '▶';
  button.setAttribute('aria-label', on ? 'stop' : 'play');
  if (!on) setCoarse(false), draw();
}
const stride = Math.max(1, Math.round(steps.count / 150));
if (steps.count > 1) {
  document.getElementById('bar').hidden = false;
  slider.max = steps.count - 1;
  slider.addEventListener('input', () => setStep(Number(slider.value)));
  document.getElementById('play').addEventListener('click', () => play(!playing));
  window.addEventListener('keydown', event => {
    if (event.target.tagName === 'INPUT' || event.target.tagName === 'BUTTON') return;
    if (event.key === ' ') play(!playing), event.preventDefault();
    if (event.key === 'ArrowRight') setStep(step + 1);
    if (event.key === 'ArrowLeft') setStep(step - 1);
  });
}

// A click on a sphere whose cells are known shows its cell.
const cells = doc.cells ? makeCells(doc.cells) : null;
function makeCells(packed) {
  return packed.map(level => ({begin: decode(level.begin), positions: decodePositions(level.positions), step: level.step}));
}
let pickedCell = null;
function pick(event) {
  const box = canvas.getBoundingClientRect(), ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height), camera);
  let best = Infinity, found = -1;
  const layer = layers.find(l => l.type === 'spheres' && l.cellsOf !== undefined && l.object.visible);
  if (!layer) return;
  for (let k = 0; k < layer.count; ++k) {
    const hit = ray.ray.intersectSphere(new THREE.Sphere(new THREE.Vector3().fromArray(layer.centers, 3 * k), layer.radii[k]), new THREE.Vector3());
    const distance = hit ? hit.distanceTo(ray.ray.origin) : Infinity;
    if (distance < best) best = distance, found = k;
  }
  showCell(layer, found);
}
function showCell(layer, sphere) {
  if (pickedCell) scene.remove(pickedCell.object), pickedCell.object.geometry.dispose(), pickedCell = null;
  document.getElementById('key').textContent = '';
  if (sphere >= 0) {
    const level = cells[layer.cellsOf], positions = level.positions.slice(3 * level.begin[sphere], 3 * level.begin[sphere + 1]);
    const object = placed(new THREE.Points(geometryOf(positions), new THREE.PointsMaterial({color: '#c80000', size: 5, sizeAttenuation: false, depthTest: false})), 9);
    pickedCell = {object, sphere, samples: positions.length / 3};
    scene.add(object);
    const [size, unit] = scaleFor('m', [layer.radii[sphere]]);
    document.getElementById('key').append(element('div', {textContent: `sphere ${sphere} · radius ${digits(layer.radii[sphere] / size)} ${unit}`}),
      element('div', {className: 'faint', textContent: `its Voronoi cell: ${pickedCell.samples} samples`}));
  }
  draw();
}
if (cells) {
  let pressed = null;
  canvas.addEventListener('pointerdown', event => { pressed = event; });
  canvas.addEventListener('pointerup', event => { if (pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < 4) pick(event); });
}

if (steps.name_of) steps.nameOf = decode(steps.name_of);
if (steps.numbers) steps.numbers = decode(steps.numbers);
const chartPlace = doc.charts.length ? section('charts') : null;
for (const chart of doc.charts) {
  if (chart.type === 'curve') cursors.push(showCurve(chartPlace, chart, columns, setStep));
  if (chart.type === 'histogram') showHistogram(chartPlace, chart);
  if (chart.type === 'picture') showPicture(chartPlace, chart, doc.layers[chart.layer].images[0]);
}
if (layers.length) showLayers(layers, refresh);
const keyed = layers.find(layer => layer.key);
if (keyed) showKey(keyed.key);
coarse = true;  // for the first picture
resize();
setStep(steps.start);
setView(doc.views[0]);

// For those who drive the page from outside.
window.vpm = {
  setStep, setView, setCoarse, pick, play,
  setLayer(name, on) { for (const layer of layers) if (layer.name === name) layer.on = layer.box.checked = on; refresh(); },
  showSphereCell(sphere) { showCell(layers.find(l => l.cellsOf !== undefined && l.object.visible), sphere); },
  // Milliseconds of one frame while the scene turns, drawn and read back.
  bench(frames) {
    const pixel = new Uint8Array(4), begin = performance.now();
    for (let k = 0; k < frames; ++k) {
      camera.position.sub(controls.target).applyAxisAngle(up, 0.05).add(controls.target);
      camera.lookAt(controls.target);
      render();
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
    }
    return (performance.now() - begin) / frames;
  },
  report() {
    return {
      title: doc.title, step, steps: steps.count, faults, firstPicture: firstPicture - started, sinceNavigation: firstPicture,
      layers: layers.map(({name, type, count, on, counts, object}) => ({name, type, count, on, counts, visible: object.visible})),
      numbers: columns.map(c => ({name: c.name, body: c.body, values: [...c.values.slice(c.size * step, c.size * step + c.size)]})),
      texts: [...document.querySelectorAll('#numbers tr')].map(row => row.textContent), where: where.textContent,
      cell: pickedCell && {sphere: pickedCell.sphere, samples: pickedCell.samples},
    };
  },
};
