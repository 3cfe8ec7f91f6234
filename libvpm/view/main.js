// Puts scene and panel together.

const faults = [];
window.addEventListener('error', event => faults.push(event.message));

const doc = JSON.parse(document.getElementById('data').textContent);
showFacts(doc);
const stage = new Stage(document.getElementById('scene'), doc);
const columns = doc.columns.map(column => ({...column, values: decode(column.values)}));
for (const column of columns) column.scale = scaleFor(column.unit, column.values);
const bodies = doc.bodies.map(body => new Body(body)), layers = makeLayers(doc, bodies, columns);
for (const body of bodies) stage.scene.add(body.group);
for (const layer of layers)
  (layer.body === undefined ? stage.scene : bodies[layer.body].group).add(layer.object);
const surfaces = layers.filter(layer => layer.type === 'surface');

// Steps: poses, levels or numbers of spheres.
const steps = doc.steps, stepNumbers = steps.numbers && decode(steps.numbers), onStep = [];
const slider = document.getElementById('slider');
let step = 0, timer = null;

function stepText() {
  if (steps.names) return steps.names[step] || '';
  if (steps.counts_up) return `${step + 1} of ${steps.count} ${steps.name}`;
  return `${steps.name} ${stepNumbers ? stepNumbers[step] : step} of 0 to ${steps.last}`;
}
function setStep(wanted) {
  step = Math.min(Math.max(wanted, 0), Math.max(steps.count - 1, 0));
  slider.value = step;
  document.getElementById('where').textContent = stepText();
  for (const body of bodies) body.atStep(step);
  for (const layer of layers) if (layer.atStep) layer.atStep(step);
  if (bodies.length) for (const layer of surfaces) layer.showTool(bodies[0].centerAt(step), bodies[0].radius, stage.up);
  for (const follow of onStep) follow(step);
  refresh();
}
function refresh() {
  refreshLayers(layers, step);
  for (const layer of surfaces) layer.fill();
  stage.draw();
}
stage.onCoarse = on => {
  for (const layer of layers) if (layer.setCoarse) layer.setCoarse(on);
  refresh();
};

// A path plays within ten seconds.
const stride = Math.max(1, Math.round(steps.count / 150));
function play(on) {
  clearInterval(timer);
  timer = on ? setInterval(() => setStep(step + stride >= steps.count ? 0 : step + stride), 1000 / 15) : null;
  stage.isPlaying = on;
  const button = document.getElementById('play');
  button.textContent = on ? '❚❚' : '▶';
  button.setAttribute('aria-label', on ? 'stop' : 'play');
  if (!on) stage.rest();
}
function makeBar() {
  document.getElementById('bar').hidden = false;
  slider.max = steps.count - 1;
  slider.addEventListener('input', () => setStep(Number(slider.value)));
  document.getElementById('play').addEventListener('click', () => play(!timer));
  window.addEventListener('keydown', event => {
    if (event.target.tagName === 'INPUT' || event.target.tagName === 'BUTTON') return;
    if (event.key === ' ') play(!timer), event.preventDefault();
    if (event.key === 'ArrowRight') setStep(step + 1);
    if (event.key === 'ArrowLeft') setStep(step - 1);
  });
}
if (steps.count > 1) makeBar();

// Points of view, with a button each.
const viewpoints = makeViewpoints(stage, layers, bodies, steps.moves);
const buttons = doc.views.map(name => {
  const button = element('button', {type: 'button', textContent: name[0].toUpperCase() + name.slice(1)});
  button.addEventListener('click', () => setView(name));
  document.getElementById('views').append(button);
  return button;
});
function markView(name) {
  doc.views.forEach((view, k) => buttons[k].setAttribute('aria-pressed', String(view === name)));
}
function setView(name) {
  markView(name);
  viewpoints[name]();
}
stage.controls.addEventListener('start', () => markView(null));

onStep.push(showNumbers(doc, bodies, columns));
for (const chart of doc.charts) onStep.push(showChart(chart, columns, doc, setStep));
if (layers.length) showLayers(layers, refresh);
const keyed = layers.find(layer => layer.key || layer.byNormal);
if (keyed) showKey(keyed);
const cells = doc.cells ? makeCellPicker(stage, layers, doc.cells) : null;
if (cells) onStep.push(cells.hide);

for (const layer of layers) if (layer.setCoarse) layer.setCoarse(true);
stage.resize();
setStep(steps.start);
setView(doc.views[0]);

// For those who drive the page from outside: tests and pictures.
window.vpm = {
  setStep, setView, play,
  setCoarse: on => stage.setCoarse(on),
  setQuality: quality => stage.setQuality(quality),
  setLayer(name, on) {
    for (const layer of layers) if (layer.name === name) layer.on = layer.row.box.checked = on;
    refresh();
  },
  showCell: sphere => cells.show(sphere),
  bench: frames => stage.bench(frames),
  report() {
    return {
      title: doc.title, step, steps: steps.count, where: stepText(), faults,
      firstPicture: stage.firstPicture, bySoftware: stage.bySoftware, load: stage.load(),
      layers: layers.map(({name, type, count, on, counts, object}) => ({name, type, count, on, counts, visible: object.visible})),
      bodies: bodies.map(body => ({name: body.name, center: body.centerAt(step).toArray()})),
      numbers: columns.map(c => ({name: c.name, body: c.body, values: [...c.values.slice(c.size * step, c.size * step + c.size)]})),
      texts: [...document.querySelectorAll('#numbers tr')].map(row => row.textContent),
      cell: cells && cells.report(),
    };
  },
};
