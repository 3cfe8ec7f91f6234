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
  if (look.color) made.style.background = look.color;
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
  const told = [...new Set(columns.map(column => column.body))];
  for (const body of told) {
    const title = told.length > 1 && body >= 0 ? bodies[body].name : 'Numbers', table = element('table', {});
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

// Adds a switch for each layer, with what its colours mean. Layers of equal names that are shown at one step each
// share a switch.
function showLayers(layers, changed) {
  const place = section('layers', 'Layers'), rows = new Map();
  for (const layer of layers) {
    const row = layer.step !== undefined && rows.get(layer.name);
    layer.row = row || addRow(place, layer, changed);
    layer.row.layers.push(layer);
    rows.set(layer.name, layer.row);
  }
}
function addRow(place, layer, changed) {
  const box = element('input', {type: 'checkbox', checked: layer.on}), cell = element('span', {className: 'count'}), row = {box, cell, layers: []};
  const line = element('label', {className: 'row'}, box, swatch(layer.swatch), element('span', {className: 'name', textContent: layer.name}));
  box.addEventListener('change', () => {
    for (const member of row.layers) member.on = box.checked;
    changed();
  });
  if (layer.opacity) line.append(opacityRange(layer, changed));
  line.append(cell);
  place.append(line, ...(layer.legend || []).map(entry => legendLine(layer, entry, changed)));
  return row;
}
function opacityRange(layer, changed) {
  const range = element('input', {type: 'range', className: 'opacity', min: 0.1, max: 1, step: 0.05, value: layer.opacity.value, title: 'opacity of ' + layer.name});
  range.addEventListener('input', () => { layer.opacity.value = Number(range.value); changed(); });
  return range;
}
// Returns a line of a layer's legend; that of a state has a switch and the number of its spheres.
function legendLine(layer, [name, color, form, state], changed) {
  const line = element('label', {className: 'row indent'}), cell = element('span', {className: 'count'});
  if (state !== undefined) {
    const box = element('input', {type: 'checkbox', checked: true, title: 'show spheres that are ' + name});
    box.addEventListener('change', () => { layer.shownStates.setComponent(state, box.checked ? 1 : 0); changed(); });
    line.append(box);
    (layer.stateCells = layer.stateCells || [])[state] = cell;
  }
  line.append(swatch({color, shape: form}), element('span', {className: 'name', textContent: name}), cell);
  return line;
}
function refreshLayers(layers, step) {
  for (const layer of layers) if (layer.row) layer.row.cell.textContent = layer.step === undefined ? '' : '0';
  for (const layer of layers) {
    const isHere = !layer.isAbsent && (layer.step === undefined || layer.step === step);
    layer.object.visible = layer.on && isHere;
    if (!layer.row || !isHere) continue;
    layer.row.cell.textContent = layer.count === undefined ? '' : layer.count.toLocaleString('en') + (layer.unit ? ' ' + layer.unit : '');
    if (layer.stateCells) layer.stateCells.forEach((cell, k) => { cell.textContent = layer.counts[k].toLocaleString('en'); });
  }
}

function valueText(value, unit) {
  const [size, name] = scaleFor(unit, [value]);
  return digits(value / size) + ' ' + name;
}

// Shows in the corner of the scene what its colours mean: radii, or directions of normals.
function showKey(layer) {
  const place = document.getElementById('key');
  if (layer.key) place.append(...scaleKey(layer.key));
  else if (layer.byNormal) place.append(...normalKey());
}
function scaleKey({name, unit, low, high}) {
  const canvas = element('canvas', {width: 160, height: 1}), context = canvas.getContext('2d');
  for (let k = 0; k < 160; ++k) {
    context.fillStyle = `rgb(${viridis(k / 159).map(Math.round)})`;
    context.fillRect(k, 0, 1, 1);
  }
  const ends = [low, high].map(value => element('span', {textContent: valueText(value, unit)}));
  return [element('span', {textContent: name}), canvas, element('div', {className: 'ends'}, ...ends)];
}
// A ball as the camera would see it, in the colours of its normals.
function normalKey() {
  const size = 64, canvas = element('canvas', {className: 'ball', width: size, height: size});
  const context = canvas.getContext('2d'), pixels = context.createImageData(size, size);
  for (let v = 0, k = 0; v < size; ++v) for (let u = 0; u < size; ++u, k += 4) {
    const x = 2 * (u + 0.5) / size - 1, y = 2 * (v + 0.5) / size - 1, z2 = 1 - x * x - y * y;
    if (z2 > 0) pixels.data.set([0.5 + 0.5 * x, 0.5 - 0.5 * y, 0.5 + 0.5 * Math.sqrt(z2), 1].map(c => 255 * c), k);
  }
  context.putImageData(pixels, 0, 0);
  return [element('div', {textContent: 'normal'}), canvas, element('div', {className: 'faint', textContent: 'as a ball would show them'})];
}
