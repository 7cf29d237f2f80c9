// SPDX-License-Identifier: MIT
// The page of one ray: the picture, which can be zoomed as far as numbers reach, and the table of steps.
const data = JSON.parse(byId('data').textContent);
const steps = data.walk.steps;
const number = value => typeof value === 'number' ? value : { nan: NaN, inf: Infinity, '-inf': -Infinity }[value] ?? 0;
const short = value => typeof value === 'string' ? value : Number((value || 0).toPrecision(7)).toString();
const space = s => s === undefined || s === null ? '' : ` behind transform ${s}`;
const place = s => `cell (${s.x}, ${s.y})${s.node === null || s.node === undefined ? '' : ', node ' + s.node}${space(s.space)}`;

// ---- The picture ----
const kSvg = 'http://www.w3.org/2000/svg';
const draw = (tag, attributes, ...children) => {
  const element = document.createElementNS(kSvg, tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
};
const slice = data.slice;
const shapes = slice.shapes.map(s => {
  const shape = { ...s };
  if (s.ellipse) {
    const [x, y, rx, ry, angle] = s.ellipse.map(number), c = Math.cos(angle), n = Math.sin(angle);
    const w = Math.hypot(rx * c, ry * n), h = Math.hypot(rx * n, ry * c);
    Object.assign(shape, { x, y, rx, ry, c, n, box: [x - w, y - h, x + w, y + h] });
  } else {
    shape.points = s.points.map(p => p.map(number));
    const xs = shape.points.map(p => p[0]), ys = shape.points.map(p => p[1]);
    shape.box = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
  }
  shape.onChain = s.step !== null && !!steps[s.step]?.on_chain;
  return shape;
});
const marks = slice.marks.map(m => ({ ...m, x: number(m.x) })).filter(m => Number.isFinite(m.x));
const svg = draw('svg', {});
byId('slice').append(svg);
let view = { x: 0, y: 0, scale: 1 }, picked = null;

function fit(boxes, share = 0.8) {
  const { width, height } = svg.getBoundingClientRect();
  const lo = [Math.min(...boxes.map(b => b[0])), Math.min(...boxes.map(b => b[1]))];
  const hi = [Math.max(...boxes.map(b => b[2])), Math.max(...boxes.map(b => b[3]))];
  const size = [hi[0] - lo[0], hi[1] - lo[1]];
  const scale = share * Math.min(width / (size[0] || Number.MIN_VALUE), height / (size[1] || Number.MIN_VALUE));
  view = { x: (lo[0] + hi[0]) / 2, y: (lo[1] + hi[1]) / 2, scale: Number.isFinite(scale) ? scale : 1 };
}
// An outline in pixels. Of an ellipse far larger than the window only the arc near it: the rest would cost precision.
function outline(shape, width, height) {
  const at = (x, y) => [(x - view.x) * view.scale + width / 2, height / 2 - (y - view.y) * view.scale];
  if (!shape.ellipse) return shape.points.map(p => at(p[0], p[1]));
  const { x, y, rx, ry, c, n } = shape;
  const dx = view.x - x, dy = view.y - y;
  const middle = Math.atan2((-dx * n + dy * c) / ry, (dx * c + dy * n) / rx);
  const reach = 2 * (width + height) / view.scale / Math.min(rx, ry);
  const half = Math.min(Math.PI, reach), count = 512;
  const list = [];
  for (let i = 0; i <= count; ++i) {
    const a = middle + half * (2 * i / count - 1), p = rx * Math.cos(a), q = ry * Math.sin(a);
    list.push(at(x + p * c - q * n, y + p * n + q * c));
  }
  return list;
}
const pathOf = points => points.map((p, i) => (i ? 'L' : 'M') + p[0].toFixed(2) + ' ' + p[1].toFixed(2)).join('');
function tickText(value, step) {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return digits <= 14 && Math.abs(value) < 1e9 ? value.toFixed(digits) : value.toExponential(4);
}
function redraw() {
  const { width, height } = svg.getBoundingClientRect();
  if (!width) return;
  svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
  const parts = [];
  const xOf = x => (x - view.x) * view.scale + width / 2, yOf = y => height / 2 - (y - view.y) * view.scale;
  const clamp = v => Math.max(-10, Math.min(width + 10, v));
  for (const shape of shapes) {
    const [x0, y0, x1, y1] = shape.box;
    if (xOf(x1) < 0 || xOf(x0) > width || yOf(y0) < 0 || yOf(y1) > height) continue;
    const isPicked = picked !== null && shape.step === picked;
    const path = draw('path', { d: pathOf(outline(shape, width, height)) + (shape.ellipse || shape.points.length > 2 ? 'Z' : ''),
      class: `r-${shape.role}${shape.onChain ? ' r-chain' : ''}${isPicked ? ' r-picked' : ''}` },
      draw('title', {}, shape.label));
    path.onclick = () => { if (shape.step !== null) pick(shape.step, true); };
    parts.push(path);
  }
  const end = marks.find(m => m.role === 't_max');
  parts.push(draw('path', { class: 'r-ray', d: `M${clamp(xOf(0))} ${yOf(0)}L${clamp(end ? xOf(end.x) : width + 10)} ${yOf(0)}` }));
  let above = true;
  for (const mark of marks) {
    const x = xOf(mark.x);
    if (x < 0 || x > width) continue;
    parts.push(draw('circle', { class: `dot m-${mark.role}`, cx: x, cy: yOf(0), r: 4 }, draw('title', {}, mark.label)));
    const left = x > width * 0.6;
    parts.push(draw('text', { class: `m-${mark.role}`, x: left ? x - 6 : x + 6, y: yOf(0) + (above ? -9 : 19), 'text-anchor': left ? 'end' : 'start' }, mark.label));
    above = !above;
  }
  // The axis: distances along the ray.
  const axis = draw('g', { class: 'axis' });
  const raw = 90 / view.scale, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].find(k => k * power >= raw) * power;
  const first = Math.ceil((view.x - width / 2 / view.scale) / step);
  axis.append(draw('rect', { x: 0, y: height - 34, width, height: 34 }));
  axis.append(draw('line', { x1: 0, x2: width, y1: height - 34, y2: height - 34 }));
  for (let i = 0; i < 60; ++i) {
    const value = (first + i) * step, x = xOf(value);
    if (x > width) break;
    axis.append(draw('line', { x1: x, x2: x, y1: height - 34, y2: height - 29 }));
    axis.append(draw('text', { x, y: height - 17, 'text-anchor': 'middle' }, tickText(value, step)));
  }
  axis.append(draw('text', { x: width / 2, y: height - 3, 'text-anchor': 'middle' }, `world units along the ray${Math.abs(number(slice.length) - 1) > 1e-6 ? `; t = distance / ${short(slice.length)}` : ' (t)'}`));
  parts.push(axis);
  svg.replaceChildren(...parts);
}
const scaleBy = (factor, px, py) => {
  const { width, height } = svg.getBoundingClientRect();
  const dx = (px ?? width / 2) - width / 2, dy = height / 2 - (py ?? height / 2);
  view.x += dx / view.scale * (1 - 1 / factor);
  view.y += dy / view.scale * (1 - 1 / factor);
  view.scale *= factor;
  redraw();
};
{
  const important = shapes.filter(s => s.role === 'truth' || s.role === 'answer' || s.role === 'fault');
  const points = marks.map(m => [m.x, 0, m.x, 0]);
  const fault = shapes.find(s => s.role === 'fault') || null;
  const tools = byId('views');
  const button = (text, act) => {
    const b = make('button', { type: 'button' }, text);
    b.onclick = () => { act(); redraw(); };
    tools.append(b);
    return act;
  };
  const met = shapes.filter(s => s.role === 'entered' || important.includes(s));
  const whole = button('Whole ray', () => fit([...points, ...shapes.map(s => s.box)].filter(b => b.every(Number.isFinite))));
  let first = met.length ? button('What was entered', () => fit([...marks.filter(m => m.role === 'truth' || m.role === 'answer').map(m => [m.x, 0, m.x, 0]), ...met.slice(-12).map(s => s.box)])) : whole;
  if (fault) first = button('Where they part', () => fit([fault.box, ...points.filter(p => p[0] >= fault.box[0] && p[0] <= fault.box[2])], 0.7));
  if (fault?.ellipse) {
    // The gap between the ray and the nearest point of the volume.
    const side = fault.y > 0 ? -1 : 1, height = Math.hypot(fault.rx * fault.n, fault.ry * fault.c);
    const x = fault.x + side * (fault.rx * fault.rx - fault.ry * fault.ry) * fault.n * fault.c / height, y = fault.y + side * height;
    const gap = Math.abs(y) || 1e-6 * height;
    if (gap < 0.1 * height) button('Up close', () => fit([[x - gap, Math.min(0, y) - gap, x + gap, Math.max(0, y) + gap]], 0.9));
  }
  const zoom = (text, factor, label) => {
    const b = make('button', { type: 'button', ariaLabel: label }, text);
    b.onclick = () => scaleBy(factor);
    tools.append(b);
  };
  zoom('−', 0.5, 'Zoom out');
  zoom('+', 2, 'Zoom in');
  first();
  redraw();
  let drag = null;
  const area = byId('slice');
  area.addEventListener('wheel', event => {
    event.preventDefault();
    const box = svg.getBoundingClientRect();
    scaleBy(event.deltaY < 0 ? 1.3 : 1 / 1.3, event.clientX - box.left, event.clientY - box.top);
  }, { passive: false });
  area.onpointerdown = event => { drag = { x: event.clientX, y: event.clientY, from: { ...view } }; };
  addEventListener('pointermove', event => {
    if (!drag) return;
    view.x = drag.from.x - (event.clientX - drag.x) / view.scale;
    view.y = drag.from.y + (event.clientY - drag.y) / view.scale;
    redraw();
  });
  addEventListener('pointerup', () => { drag = null; });
  area.onkeydown = event => {
    const move = { ArrowLeft: [-40, 0], ArrowRight: [40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] }[event.key];
    if (move) { view.x += move[0] / view.scale; view.y += move[1] / view.scale; event.preventDefault(); redraw(); }
    if (event.key === '+' || event.key === '=') scaleBy(2);
    if (event.key === '-') scaleBy(0.5);
  };
  addEventListener('resize', redraw);
  const words = { entered: 'volume that the ray entered', rejected: 'volume that rejected it', fault: 'volume at fault', truth: 'truth', answer: "the tracer's answer" };
  for (const [role, text] of Object.entries(words)) {
    const count = shapes.filter(s => s.role === role).length;
    if (!count) continue;
    byId('legend').append(make('li', {}, draw('svg', { viewBox: '0 0 28 12', 'aria-hidden': 'true' }, draw('path', { class: 'r-' + role, d: 'M1 6H27' })), count > 1 ? `${text} (${count})` : text));
  }
  const under = [`A cut by a plane that holds the ray${fault ? ' and the middle of the volume at fault' : ''}; distances to scale. Wheel or + and − zoom, drag or arrows move.`];
  if (slice.not_cut) under.push(`${slice.not_cut} volumes do not meet the plane.`);
  if (slice.left_out) under.push(`${slice.left_out} are left out.`);
  byId('under').textContent = under.join(' ');
  area.setAttribute('aria-label', `${data.sentence}. The walk below tells the same in words.`);
}

// ---- The walk ----
const boxes = data.bounds === 'aabb';
function numbersOf(s) {
  if (s.test === 'end') return '';
  const so = `nearest ${short(s.bound)}`;
  return boxes ? `enter ${short(s.enter)}, leave ${short(s.leave)}, ${so}` : `d² ${short(s.distance2)}, r² ${short(s.radius2)}, ${so}`;
}
function eventsOf(s) {
  const lines = [];
  for (const p of s.primitives || []) lines.push(`primitive ${p.primitive ?? '?'}: ${p.outcome.replaceAll('_', ' ')}${p.outcome === 'outside' ? '' : ' at t = ' + short(p.t)}`);
  for (const c of s.changes || []) lines.push(c.kind === 'resumed' ? 'goes on in another pass' : `${c.kind} transform ${c.node}`);
  if (s.again) lines.push('the leaf once more');
  if (s.ended) lines.push('the end');
  return lines;
}
const rows = new Map();
function pick(index, scroll) {
  picked = index;
  for (const [i, row] of rows) row.classList.toggle('picked', i === index);
  if (scroll && rows.has(index)) rows.get(index).scrollIntoView({ block: 'nearest' });
  redraw();
}
{
  const mount = byId('walk');
  const notes = [`${data.walk.total_steps.toLocaleString('en')} steps, as the production shader walked them.`];
  if (steps.length < data.walk.total_steps) notes.push(`${steps.length.toLocaleString('en')} are kept here.`);
  if (data.walk.skipped) notes.push(`${data.walk.skipped.toLocaleString('en')} later events were not captured.`);
  if (!data.walk.driver_agrees) notes.push("The driver's pixels that walked this ray came to different ends.");
  byId('walk-note').textContent = notes.join(' ');
  const filter = make('input', { type: 'search', placeholder: 'Filter steps', ariaLabel: 'Filter steps' });
  const reasons = [...new Set(steps.map(s => s.reason))].sort();
  const select = make('select', { ariaLabel: 'Reason' }, make('option', { value: '' }, 'all reasons'),
    ...reasons.map(r => make('option', { value: r }, `${r} (${steps.filter(s => s.reason === r).length.toLocaleString('en')})`)));
  const only = make('input', { type: 'checkbox', checked: steps.length > 60 });
  const count = make('span', { className: 'soft', ariaLive: 'polite' });
  const columns = [['step', 'n', s => s.number], ['where', '', s => (s.space ?? -1) * 2 ** 32 + s.cell], ['way taken', '', s => s.reason], ['numbers', '', null], ['what happened', '', null]];
  const head = make('tr'), body = make('tbody');
  let order = steps.map((s, i) => i), shown = 200;
  for (const [name, className, key] of columns) {
    const cell = make('th', { scope: 'col', className });
    if (key) {
      const button = make('button', { type: 'button' }, name);
      button.onclick = () => {
        const sign = cell.getAttribute('aria-sort') === 'ascending' ? -1 : 1;
        for (const other of head.children) other.removeAttribute('aria-sort');
        cell.setAttribute('aria-sort', sign > 0 ? 'ascending' : 'descending');
        order = steps.map((s, i) => i).sort((a, b) => { const x = key(steps[a]), y = key(steps[b]); return sign * (x < y ? -1 : x > y ? 1 : a - b); });
        list();
      };
      cell.append(button);
    } else {
      cell.append(name);
    }
    head.append(cell);
  }
  const more = make('button', { type: 'button', className: 'more' }, 'Show more');
  const list = () => {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = order.filter(i => {
      const s = steps[i];
      if (only.checked && !s.notable) return false;
      if (select.value && s.reason !== select.value) return false;
      const text = `${s.number} ${place(s)} ${s.reason} ${eventsOf(s).join(' ')}`.toLowerCase();
      return words.every(w => text.includes(w));
    });
    rows.clear();
    body.replaceChildren(...kept.slice(0, shown).map(i => {
      const s = steps[i], events = make('td', { className: 'what' });
      eventsOf(s).forEach((line, k) => events.append(...(k ? [make('br')] : []), line));
      const way = make('td', { className: 'chip' }, s.reason);
      if (s.on_chain) way.append(make('br'), make('small', {}, 'above the truth'));
      const row = make('tr', {}, make('td', { className: 'n' }, String(s.number)), make('td', {}, place(s)), way, make('td', { className: 'numbers' }, numbersOf(s)), events);
      if (i === data.fault.step) row.classList.add('fault');
      if (i === picked) row.classList.add('picked');
      row.onclick = () => pick(i);
      rows.set(i, row);
      return row;
    }));
    count.textContent = `${kept.length.toLocaleString('en')} of ${data.walk.total_steps.toLocaleString('en')} steps`;
    more.hidden = kept.length <= shown;
  };
  filter.oninput = select.onchange = only.onchange = () => { shown = 200; list(); };
  more.onclick = () => { shown += 800; list(); };
  mount.append(make('div', { className: 'tools' }, filter, select, make('label', {}, only, ' only what tells something'), count),
    make('div', { className: 'scroll', tabIndex: 0, role: 'region', ariaLabel: 'Steps' }, make('table', { className: 'walk' }, make('thead', {}, head), body)), more);
  list();
}

// ---- The chain, and the other walk ----
if (data.chain.length) {
  const body = make('tbody');
  for (const a of data.chain) {
    const s = a.step === null ? null : steps[a.step];
    const row = make('tr', {}, make('td', {}, place(a)), make('td', { className: 'n' }, s ? String(s.number) : ''), make('td', { className: 'chip' }, s ? s.reason : 'not visited'),
      make('td', { className: 'numbers' }, s ? numbersOf(s) : ''), make('td', {}, a.transform === null ? '' : `leads into transform ${a.transform}`));
    if (a.cell === data.fault.cell && a.space === data.fault.space) row.classList.add('fault');
    if (a.step !== null) row.onclick = () => pick(a.step);
    body.append(row);
  }
  const heads = make('tr');
  for (const name of ['node', 'step', 'way taken', 'numbers', '']) heads.append(make('th', { scope: 'col' }, name));
  byId('chain').append(make('div', { className: 'scroll', tabIndex: 0, role: 'region', ariaLabel: 'Chain' }, make('table', { className: 'walk' }, make('thead', {}, heads), body)));
  byId('chain').hidden = false;
}
if (data.against) {
  const c = data.against, mount = byId('against');
  mount.hidden = false;
  mount.append(make('p', {}, make('b', {}, c.same ? 'No difference' : c.sentence)), make('p', { className: 'caption' }, `Against ${c.with}, which answers: ${c.second_answer}. Compared: ${c.note}.`));
  if (!c.same) {
    const side = (title, s) => make('div', {}, make('h3', {}, title), make('pre', {}, s ? JSON.stringify(s, null, 1) : 'has ended'));
    mount.append(make('div', { className: 'sides' }, side('This walk', c.first), side('The other', c.second)));
  }
}
