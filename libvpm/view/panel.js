// The panel beside the scene. Every text of the document enters the page as text, never as markup.

function element(name, properties, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}
function shape(name, attributes, text) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  return made;
}
function section(id, title) {
  const place = document.getElementById(id);
  place.hidden = false;
  if (title) place.append(element('h2', {textContent: title}));
  return place;
}
function swatch(look) {
  const made = element('span', {className: 'swatch ' + (look.shape || '')});
  if (look.color && look.shape !== 'hatch') made.style.background = look.color;
  return made;
}

function showFacts(doc) {
  document.title = doc.title + ' · ' + doc.program;
  document.getElementById('title').textContent = doc.title;
  document.getElementById('program').textContent = doc.program + ' ' + doc.version + (doc.summary ? ' · ' + doc.summary : '');
  const table = element('table', {});
  for (const [name, value] of doc.facts)
    table.append(element('tr', {}, element('td', {textContent: name, className: 'faint'}), element('td', {textContent: value})));
  if (doc.facts.length) section('facts', 'About').append(table);
  for (const note of doc.notes) section('notes').append(element('p', {textContent: note}));
}

// Returns a function that shows the numbers of a step.
function showNumbers(doc, bodies, columns) {
  if (!columns.length) return () => {};
  const place = section('numbers'), cells = [];
  for (const body of [...new Set(columns.map(column => column.body))]) {
    const title = bodies.length > 1 && body >= 0 ? bodies[body].name : 'Numbers', table = element('table', {});
    place.append(element('h2', {textContent: title}), table);
    columns.filter(column => column.body === body).forEach((column, k) => {
      const cell = element('td', {className: k === 0 ? 'big' : ''});
      table.append(element('tr', {}, element('td', {textContent: column.name}), cell));
      cells.push({column, cell});
    });
  }
  return step => {
    for (const {column, cell} of cells) {
      const [size, unit] = column.scale, n = column.size, values = [...column.values.slice(n * step, n * step + n)];
      const length = n === 1 ? values[0] : Math.hypot(...values);
      cell.textContent = numberOf(column, length / size) + (unit ? ' ' + unit : '');
      if (n > 1) cell.append(element('div', {className: 'faint', textContent: '(' + values.map(v => digits(v / size)).join(', ') + ')'}));
    }
  };
}
function numberOf(column, value) { return column.unit === '' ? String(value) : digits(value); }

// A switch for each layer, with what its colours mean.
function showLayers(layers, changed) {
  const place = section('layers', 'Layers');
  for (const layer of layers) {
    const box = element('input', {type: 'checkbox', checked: layer.on});
    box.addEventListener('change', () => { layer.on = box.checked; changed(); });
    layer.box = box;
    layer.countCell = element('span', {className: 'count'});
    const row = element('label', {className: 'row'}, box, swatch(layer.swatch), element('span', {className: 'name', textContent: layer.name}), layer.countCell);
    place.append(row);
    for (const [name, color, form, state] of layer.legend || []) {
      const cell = element('span', {className: 'count'}), line = element('label', {className: 'row indent'});
      if (state !== undefined) {
        const shown = element('input', {type: 'checkbox', checked: true, title: 'show spheres that are ' + name});
        shown.addEventListener('change', () => { layer.shown.setComponent(state, shown.checked ? 1 : 0); changed(); });
        line.append(shown);
        (layer.stateCells = layer.stateCells || [])[state] = cell;
      }
      line.append(swatch({color, shape: form}), element('span', {className: 'name', textContent: name}), cell);
      place.append(line);
    }
    if (layer.opacity) {
      const range = element('input', {type: 'range', min: 0.1, max: 1, step: 0.05, value: layer.opacity.value, title: 'opacity'});
      range.style.cssText = 'width: 60px; flex: none;';
      range.addEventListener('input', () => { layer.opacity.value = Number(range.value); changed(); });
      row.insertBefore(range, layer.countCell);
    }
  }
}
function refreshLayers(layers, step) {
  for (const layer of layers) {
    layer.object.visible = layer.on && (layer.step === undefined || layer.step === step);
    layer.countCell.textContent = layer.count === undefined ? '' : layer.count.toLocaleString('en') + (layer.unit ? ' ' + layer.unit : '');
    if (layer.stateCells) layer.stateCells.forEach((cell, k) => { cell.textContent = layer.counts[k].toLocaleString('en'); });
  }
}

const WIDTH = 308, HEIGHT = 150, LEFT = 46, BOTTOM = 26, TOP = 8, RIGHT = 8;
function ticksOf(low, high) {
  const raw = (high - low) / 4, power = Math.pow(10, Math.floor(Math.log10(raw || 1)));
  const step = power * ([1, 2, 5, 10].find(m => m * power >= raw) || 10), ticks = [];
  for (let t = Math.ceil(low / step - 1e-9) * step; t <= high + 1e-9 * step; t += step) ticks.push(Math.abs(t) < 1e-12 * step ? 0 : t);
  return ticks;
}
// Returns {svg, x(value), y(value)} with axes and their names.
function axes(x, y) {
  const svg = shape('svg', {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: 'chart', role: 'img'});
  const at = (low, high, from, to) => v => from + (to - from) * (high > low ? (v - low) / (high - low) : 0);
  const px = at(x.low, x.high, LEFT, WIDTH - RIGHT), py = at(y.low, y.high, HEIGHT - BOTTOM, TOP + 12);
  for (const t of ticksOf(y.low, y.high))
    svg.append(shape('line', {x1: LEFT, x2: WIDTH - RIGHT, y1: py(t), y2: py(t), stroke: '#e3e8ee'}), shape('text', {x: LEFT - 5, y: py(t) + 4, 'text-anchor': 'end'}, Number(t.toPrecision(6))));
  for (const t of ticksOf(x.low, x.high))
    svg.append(shape('text', {x: px(t), y: HEIGHT - BOTTOM + 12, 'text-anchor': 'middle'}, Number(t.toPrecision(6))));
  svg.append(shape('text', {x: LEFT, y: TOP + 3, 'text-anchor': 'start'}, y.name), shape('text', {x: WIDTH - RIGHT, y: HEIGHT - 2, 'text-anchor': 'end'}, x.name));
  return {svg, px, py};
}
const CURVE_COLORS = ['#c80000', '#0072b2', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];

// A curve over the steps with a cursor; a click goes to the step. Returns a function that moves the cursor.
function showCurve(place, chart, columns, setStep) {
  const series = chart.columns.map(k => columns[k]), [size, unit] = scaleFor(series[0].unit, series.flatMap(s => [...s.values]));
  const values = series.map(s => s.values.map(v => v / size)), count = values[0].length, first = chart.first || 0, every = chart.every || 1, last = first + every * Math.max(count - 1, 1);
  let low = 0, high = 0;
  for (const curve of values) for (const v of curve) low = Math.min(low, v), high = Math.max(high, v);
  const {svg, px, py} = axes({name: chart.x, low: first, high: last}, {name: chart.y + (unit ? ', ' + unit : ''), low, high: high > low ? high : low + 1});
  values.forEach((curve, k) => svg.append(shape('polyline', {fill: 'none', stroke: CURVE_COLORS[k % CURVE_COLORS.length], 'stroke-width': 2,
    points: Array.from(curve, (v, step) => px(first + every * step).toFixed(1) + ',' + py(v).toFixed(1)).join(' ')})));
  const line = shape('line', {y1: TOP, y2: HEIGHT - BOTTOM, stroke: '#1d2733', 'stroke-dasharray': '3 3'});
  const dots = values.map((_, k) => shape('circle', {r: 4, fill: CURVE_COLORS[k % CURVE_COLORS.length], stroke: '#fff'}));
  svg.append(line, ...dots);
  const go = event => {
    const box = svg.getBoundingClientRect(), x = (event.clientX - box.left) * WIDTH / box.width;
    setStep(Math.round((x - LEFT) / (WIDTH - RIGHT - LEFT) * Math.max(count - 1, 1)));
  };
  svg.addEventListener('pointerdown', event => { svg.setPointerCapture(event.pointerId); go(event); });
  svg.addEventListener('pointermove', event => { if (event.buttons) go(event); });
  place.append(element('h2', {textContent: chart.title}), svg);
  if (series.length > 1) chart.names.forEach((name, k) =>
    place.append(element('div', {className: 'row indent'}, swatch({color: CURVE_COLORS[k % CURVE_COLORS.length], shape: 'line'}), element('span', {textContent: name}))));
  return step => {
    const k = Math.min(step, count - 1);
    line.setAttribute('x1', px(first + every * k)), line.setAttribute('x2', px(first + every * k));
    dots.forEach((dot, s) => { dot.setAttribute('cx', px(first + every * k)), dot.setAttribute('cy', py(values[s][k])); });
  };
}

function showHistogram(place, chart) {
  const counts = decode(chart.counts), high = Math.max(...counts, 1), [size, unit] = [1, chart.unit];
  const {svg, px, py} = axes({name: chart.x + ', ' + unit, low: chart.low / size, high: chart.high / size}, {name: chart.y, low: 0, high});
  const width = (chart.high - chart.low) / counts.length;
  counts.forEach((n, k) => {
    const x = px(chart.low + k * width), rgb = viridis(1 - (k + 0.5) / counts.length).map(Math.round);
    svg.append(shape('rect', {x, width: Math.max(px(chart.low + (k + 1) * width) - x - 0.5, 0.5), y: py(n), height: py(0) - py(n), fill: `rgb(${rgb})`}));
  });
  place.append(element('h2', {textContent: chart.title}), svg);
}

const REASON_COLORS = [null, '#1a1a1a', '#cc79a7', '#d55e00'];
// The depth image, near yellow, far violet, with unset pixels in the colour of their reason.
function showPicture(place, chart, image) {
  const depth = decodeDepth(image), bits = decode(image.reasons), reasons = new Uint8Array(depth.length);
  statesOfStep(bits, depth.length, 0, reasons);
  const canvas = element('canvas', {className: 'picture', width: image.width, height: image.height});
  const context = canvas.getContext('2d'), pixels = context.createImageData(image.width, image.height);
  const rgb = REASON_COLORS.map(c => c && new THREE.Color(c).toArray().map(x => Math.round(255 * x)));
  for (let k = 0; k < depth.length; ++k)
    pixels.data.set([...(reasons[k] ? rgb[reasons[k]] : viridis(1 - (depth[k] - image.low) / (Math.min(image.high, 2.5 * image.median) - image.low || 1))), 255], 4 * k);
  context.putImageData(pixels, 0, 0);
  place.append(element('h2', {textContent: chart.title}), canvas);
  chart.reasons.forEach(([name, count], k) => place.append(element('div', {className: 'row indent'},
    swatch({color: k ? REASON_COLORS[k] : '#21918c'}), element('span', {textContent: name}), element('span', {className: 'count', textContent: count.toLocaleString('en')}))));
}

// The colours of a quantity, in the corner of the scene.
function showKey(key) {
  const [size, unit] = scaleFor(key.unit, [key.high]), canvas = element('canvas', {width: 160, height: 1}), context = canvas.getContext('2d');
  for (let k = 0; k < 160; ++k) context.fillStyle = `rgb(${viridis(k / 159).map(Math.round)})`, context.fillRect(k, 0, 1, 1);
  document.getElementById('key').append(element('span', {textContent: key.name + ', ' + unit}), canvas,
    element('div', {className: 'ends'}, element('span', {textContent: digits(key.low / size)}), element('span', {textContent: digits(key.high / size)})));
}
