// Curves, histograms and pictures in the panel.

const WIDTH = 308, HEIGHT = 150, LEFT = 46, BOTTOM = 26, TOP = 8, RIGHT = 8, MOST_CORNERS = 1000;
const CURVE_COLORS = ['#c80000', '#0072b2', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];
// Pixels with a normal have the colour of their depth.
const REASON_COLORS = ['#000000', '#1a1a1a', '#cc79a7', '#d55e00'];

function ticksOf(low, high) {
  const raw = (high - low) / 4, power = Math.pow(10, Math.floor(Math.log10(raw || 1)));
  const step = power * ([1, 2, 5, 10].find(m => m * power >= raw) || 10), ticks = [];
  for (let t = Math.ceil(low / step - 1e-9) * step; t <= high + 1e-9 * step; t += step)
    ticks.push(Math.abs(t) < 1e-12 * step ? 0 : Number(t.toPrecision(6)));
  return ticks;
}
// Returns {svg, px(x), py(y)}: axes with their names, and where values stand.
function axes(x, y) {
  const svg = shape('svg', {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: 'chart', role: 'img'});
  const scale = ({low, high}, from, to) => v => from + (to - from) * (high > low ? (v - low) / (high - low) : 0);
  const px = scale(x, LEFT, WIDTH - RIGHT), py = scale(y, HEIGHT - BOTTOM, TOP + 12);
  for (const t of ticksOf(y.low, y.high)) {
    svg.append(shape('line', {x1: LEFT, x2: WIDTH - RIGHT, y1: py(t), y2: py(t), stroke: '#e3e8ee'}));
    svg.append(shape('text', {x: LEFT - 5, y: py(t) + 4, 'text-anchor': 'end'}, t.toLocaleString('en')));
  }
  for (const t of ticksOf(x.low, x.high))
    svg.append(shape('text', {x: px(t), y: HEIGHT - BOTTOM + 12, 'text-anchor': px(t) > WIDTH - 20 ? 'end' : 'middle'}, t));
  svg.append(shape('text', {x: LEFT, y: TOP + 3}, y.name));
  svg.append(shape('text', {x: WIDTH - RIGHT, y: HEIGHT - 2, 'text-anchor': 'end'}, x.name));
  return {svg, px, py};
}

// Adds the chart to the panel. Returns a function that follows the steps.
function showChart(chart, columns, doc, setStep) {
  const place = section('charts');
  place.append(element('h2', {textContent: chart.title}));
  if (chart.type === 'curve') return showCurve(place, chart, columns, doc.steps, setStep);
  if (chart.type === 'histogram') showHistogram(place, chart);
  if (chart.type === 'picture') showPicture(place, chart, doc.layers[chart.layer].images[0]);
  return () => {};
}

// Adds a curve over the steps with a cursor; a click goes to the step. Returns a function that moves the cursor.
function showCurve(place, chart, columns, steps, setStep) {
  const series = chart.columns.map(k => columns[k]), count = series[0].values.length;
  const scales = series.map(s => s.scale), [size, unit] = scales.reduce((a, b) => a[0] > b[0] ? a : b);
  const curves = series.map(s => s.values.map(v => v / size));
  const numbers = steps.numbers ? decode(steps.numbers) : Uint32Array.from({length: count}, (_, k) => k + (chart.first || 0));
  let low = 0, high = 0;
  for (const curve of curves) for (const v of curve) low = Math.min(low, v), high = Math.max(high, v);
  const {svg, px, py} = axes({name: chart.x, low: numbers[0], high: numbers[count - 1]}, {name: chart.y + (unit ? ', ' + unit : ''), low, high: high > low ? high : low + 1});
  const corner = (curve, k) => px(numbers[k]).toFixed(1) + ',' + py(curve[k]).toFixed(1);
  const every = Math.ceil(count / MOST_CORNERS), color = k => CURVE_COLORS[k % CURVE_COLORS.length];
  curves.forEach((curve, s) => {
    const corners = [];
    for (let k = 0; k < count; k += every) corners.push(corner(curve, k));
    corners.push(corner(curve, count - 1));
    svg.append(shape('polyline', {fill: 'none', stroke: color(s), 'stroke-width': 2, points: corners.join(' ')}));
  });
  const line = shape('line', {y1: TOP + 12, y2: HEIGHT - BOTTOM, stroke: '#1d2733', 'stroke-dasharray': '3 3'});
  const dots = curves.map((_, s) => shape('circle', {r: 4, fill: color(s), stroke: '#fff'}));
  svg.append(line, ...dots);
  followPointer(svg, x => {
    const wanted = numbers[0] + (x - LEFT) / (WIDTH - RIGHT - LEFT) * (numbers[count - 1] - numbers[0]);
    setStep(nearest(numbers, wanted));
  });
  place.append(svg);
  if (series.length > 1) chart.names.forEach((name, s) =>
    place.append(element('div', {className: 'row indent'}, swatch({color: color(s), shape: 'line'}), element('span', {textContent: name}))));
  return step => {
    const k = Math.min(step, count - 1), x = px(numbers[k]);
    line.setAttribute('x1', x), line.setAttribute('x2', x);
    dots.forEach((dot, s) => { dot.setAttribute('cx', x), dot.setAttribute('cy', py(curves[s][k])); });
  };
}
// Returns the place of the number nearest to `wanted` among ascending ones.
function nearest(numbers, wanted) {
  let best = 0;
  numbers.forEach((number, k) => { if (Math.abs(number - wanted) < Math.abs(numbers[best] - wanted)) best = k; });
  return best;
}
// Calls `go` with the x of the chart under the pointer while it is pressed.
function followPointer(svg, go) {
  const follow = event => {
    const box = svg.getBoundingClientRect();
    go((event.clientX - box.left) * WIDTH / box.width);
  };
  svg.addEventListener('pointerdown', event => { svg.setPointerCapture(event.pointerId); follow(event); });
  svg.addEventListener('pointermove', event => { if (event.buttons) follow(event); });
}

function showHistogram(place, chart) {
  const counts = decode(chart.counts), {low, high} = chart, width = (high - low) / counts.length;
  const {svg, px, py} = axes({name: chart.x + ', ' + chart.unit, low, high}, {name: chart.y, low: 0, high: Math.max(...counts, 1)});
  counts.forEach((n, k) => {
    const x = px(low + k * width), rgb = viridis(1 - (k + 0.5) / counts.length).map(Math.round);
    svg.append(shape('rect', {x, width: Math.max(px(low + (k + 1) * width) - x - 0.5, 0.5), y: py(n), height: py(0) - py(n), fill: `rgb(${rgb})`}));
  });
  place.append(svg);
}

// Returns the colours of 256 depths from near, yellow, to far, violet.
function depthColors() {
  return Array.from({length: 256}, (_, k) => viridis(1 - k / 255).map(Math.round));
}
// Adds the depth image, with unset pixels in the colour of their reason.
function showPicture(place, chart, image) {
  const depth = decodeDepth(image), reasons = statesOfStep(decode(image.reasons), depth.length, 0, new Uint8Array(depth.length));
  const canvas = element('canvas', {className: 'picture', width: image.width, height: image.height});
  const context = canvas.getContext('2d'), pixels = context.createImageData(image.width, image.height), {data} = pixels;
  const colors = depthColors(), ofReason = REASON_COLORS.map(rgbOf), {low} = image;
  const scale = 255 / (Math.min(image.high, 2.5 * image.median) - low || 1);
  for (let k = 0, at = 0; k < depth.length; ++k, at += 4) {
    const color = reasons[k] ? ofReason[reasons[k]] : colors[Math.min(Math.max(Math.round((depth[k] - low) * scale), 0), 255)];
    data[at] = color[0], data[at + 1] = color[1], data[at + 2] = color[2], data[at + 3] = 255;
  }
  context.putImageData(pixels, 0, 0);
  place.append(canvas);
  chart.reasons.forEach(([name, count], k) => place.append(element('div', {className: 'row indent'},
    swatch(k ? {color: REASON_COLORS[k]} : {shape: 'viridis'}), element('span', {textContent: name}),
    element('span', {className: 'count', textContent: count.toLocaleString('en')}))));
}
