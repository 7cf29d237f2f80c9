// SPDX-License-Identifier: MIT
// What the page of an inspected image does, after page.js: the outline, whose rows are made when they are opened, and the
// view of the bounding volumes, drawn on a plain canvas. How nodes are packed is described in inspect_nodes.cpp.
const data = JSON.parse(byId('data').textContent);
const kRows = 200;  // children shown at once
const kDrawn = 20000;  // volumes drawn at most

// ---- Nodes ----
// Children of each node, and the roots of each region, as numbers of nodes.
for (const bake of data.bakes) {
  const { parent, region } = bake.nodes;
  bake.count = parent.length;
  bake.below = Array.from({ length: bake.count }, () => []);
  bake.roots = bake.regions.map(() => []);
  parent.forEach((p, i) => (p === null ? bake.roots[region[i]] : bake.below[p]).push(i));
}
let bake = data.bakes[0];
let chosen = -1;
const short = value => {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  const size = Math.abs(value);
  if (Number.isInteger(value) && size < 1e5) return value.toLocaleString('en');
  if (size >= 1e9) return (value / 1e9).toPrecision(3) + 'G';
  if (size >= 1e6) return (value / 1e6).toPrecision(3) + 'M';
  if (size >= 1e5) return (value / 1e3).toPrecision(3) + 'k';
  return size >= 1000 ? Math.round(value).toLocaleString('en') : String(Number(value.toPrecision(4)));
};
const kindOf = i => {
  const n = bake.nodes;
  if (!n.leaf[i]) return `${n.children[i]} children`;
  return n.transform[i] === null ? 'leaf' : `into transform ${n.transform[i]}`;
};
const told = i => {
  const n = bake.nodes;
  let text = `Node ${n.number[i]} at (${n.x[i]}, ${n.y[i]}), depth ${n.depth[i]}, ${kindOf(i)}: radius ${short(n.radius[i])}, ` +
    `${short(n.primitives[i])} primitives below, ${short(n.visits[i])} visits of which ${short(n.hits[i])} hit, ` +
    `${short(n.tests[i])} primitive tests, cost ${short(n.cost[i])}`;
  if (n.slack[i]) text += `, slack ${n.slack[i].toFixed(4)}`;
  if (n.overlap[i] !== null) text += `, overlap of children ${short(n.overlap[i])}`;
  if (n.other[i] !== null) text += `; ${short(n.other[i])} visits in the other image`;
  return text + '.';
};

// ---- Outline ----
const outline = byId('outline');
const columns = ['radius', 'prims', 'visits', 'hit %', 'cost', 'slack', 'overlap'];
const rowOf = new Map();  // of nodes that are shown
function nodeRow(i, level) {
  const n = bake.nodes;
  const kids = bake.below[i].length;
  const row = make('div', { className: 'row' });
  row.setAttribute('role', 'treeitem');
  row.setAttribute('aria-level', level);
  row.style.setProperty('--level', Math.min(level - 1, 12));
  if (kids) row.setAttribute('aria-expanded', 'false');
  row.dataset.node = i;
  const name = make('span', {}, make('span', { className: 'twist' }, kids ? '▸' : ''), `${n.number[i]} `,
    make('span', { className: 'cell' }, `(${n.x[i]}, ${n.y[i]}) ${kindOf(i)}${n.children[i] && !kids ? ', not kept' : ''}`));
  row.append(name);
  const share = n.visits[i] ? Math.round(100 * n.hits[i] / n.visits[i]) : null;
  const decimals = value => value === null ? '–' : value.toFixed(3);
  for (const text of [short(n.radius[i]), short(n.primitives[i]), short(n.visits[i]), short(share), short(n.cost[i]),
    decimals(n.slack[i] || null), decimals(n.overlap[i])])
    row.append(make('span', {}, text));
  row.setAttribute('aria-selected', i === chosen);
  rowOf.set(i, row);
  return row;
}
// Puts rows of children behind `after`, the first of them; the rest follow by a button.
function addRows(after, list, level, from = 0) {
  const part = list.slice(from, from + kRows).map(i => nodeRow(i, level));
  after.after(...part);
  if (from + kRows >= list.length) return;
  const more = make('button', { type: 'button', className: 'more' }, `${list.length - from - kRows} more`);
  more.dataset.level = level;
  more.onclick = () => { const before = more.previousElementSibling; more.remove(); addRows(lastBelow(before), list, level, from + kRows); };
  part.at(-1).after(more);
}
const levelOf = row => Number(row.dataset.level || row.getAttribute('aria-level'));
function lastBelow(row) {
  let last = row;
  while (last.nextElementSibling && levelOf(last.nextElementSibling) > levelOf(row)) last = last.nextElementSibling;
  return last;
}
function expand(row, open = true) {
  if (row.getAttribute('aria-expanded') !== String(!open)) return;
  row.setAttribute('aria-expanded', open);
  row.querySelector('.twist').textContent = open ? '▾' : '▸';
  if (open) {
    const list = row.dataset.node !== undefined ? bake.below[row.dataset.node] : bake.roots[row.dataset.region];
    addRows(row, list, levelOf(row) + 1);
    return;
  }
  while (row.nextElementSibling && levelOf(row.nextElementSibling) > levelOf(row)) {
    rowOf.delete(Number(row.nextElementSibling.dataset.node));
    row.nextElementSibling.remove();
  }
}
function showOutline() {
  rowOf.clear();
  const head = make('div', { className: 'row head' }, make('span', {}, 'node (cell) kind'));
  for (const name of columns) head.append(make('span', {}, name));
  head.setAttribute('role', 'presentation');
  outline.replaceChildren(head);
  bake.regions.forEach((name, r) => {
    const row = make('div', { className: 'row' });
    row.setAttribute('role', 'treeitem');
    row.setAttribute('aria-level', 1);
    row.style.setProperty('--level', 0);
    row.setAttribute('aria-expanded', 'false');
    row.dataset.region = r;
    row.append(make('span', { title: name }, make('span', { className: 'twist' }, '▸'), name));
    outline.append(row);
    if (r === 0) expand(row);
  });
  const first = bake.roots[0];
  if (first.length === 1 && rowOf.has(first[0])) expand(rowOf.get(first[0]));
}
// Opens all rows above a node and shows its own.
function reveal(i) {
  const chain = [];
  for (let at = i; at !== null; at = bake.nodes.parent[at]) chain.unshift(at);
  let row = outline.querySelector(`[data-region="${bake.nodes.region[i]}"]`);
  for (const at of chain) {
    expand(row);
    for (let more; !rowOf.has(at) && (more = outline.querySelector('.more')); ) more.click();
    if (!rowOf.has(at)) return;
    row = rowOf.get(at);
  }
  row.scrollIntoView({ block: 'nearest' });
}
function choose(i, from) {
  if (rowOf.has(chosen)) rowOf.get(chosen).setAttribute('aria-selected', false);
  chosen = i;
  if (i >= 0) {
    if (from !== 'outline') reveal(i);
    if (rowOf.has(i)) rowOf.get(i).setAttribute('aria-selected', true);
    byId('picked').textContent = told(i);
    if (Number(byId('region').value) !== bake.nodes.region[i]) { byId('region').value = bake.nodes.region[i]; frame(); }
    if (from !== 'view') setDepth(bake.nodes.depth[i]);
  }
  draw();
}
outline.onclick = event => {
  const row = event.target.closest('.row:not(.head)');
  if (!row) return;
  if (row.dataset.node === undefined || event.target.closest('.twist'))
    expand(row, row.getAttribute('aria-expanded') === 'false');
  focusRow(row);
  if (row.dataset.node !== undefined) choose(Number(row.dataset.node), 'outline');
};
outline.ondblclick = event => {
  const row = event.target.closest('.row:not(.head)');
  if (row && row.dataset.node !== undefined) expand(row, row.getAttribute('aria-expanded') === 'false');
};
let current = null;
function focusRow(row) {
  if (!row || !row.classList.contains('row') || row.classList.contains('head')) return;
  if (current) current.removeAttribute('tabindex');
  current = row;
  row.tabIndex = 0;
  row.focus({ preventScroll: true });
  row.scrollIntoView({ block: 'nearest' });
  if (row.dataset.node !== undefined) choose(Number(row.dataset.node), 'outline');
}
outline.onkeydown = event => {
  const row = event.target.closest('.row') || outline.querySelector('.row:not(.head)');
  const step = (from, way) => { let next = from[way]; while (next && !next.classList.contains('row')) next = next[way]; return next; };
  if (event.key === 'ArrowDown') focusRow(event.target === outline ? row : step(row, 'nextElementSibling'));
  else if (event.key === 'ArrowUp') focusRow(step(row, 'previousElementSibling'));
  else if (event.key === 'ArrowRight' || event.key === 'Enter') {
    if (row.getAttribute('aria-expanded') === 'true' && event.key === 'ArrowRight') focusRow(step(row, 'nextElementSibling'));
    else expand(row, row.getAttribute('aria-expanded') === 'false');
  } else if (event.key === 'ArrowLeft') {
    if (row.getAttribute('aria-expanded') === 'true') expand(row, false);
    else { let up = row; while (up && (!up.classList.contains('row') || levelOf(up) >= levelOf(row))) up = up.previousElementSibling; focusRow(up); }
  } else if (event.key === 'Home') focusRow(outline.querySelector('.row:not(.head)'));
  else return;
  event.preventDefault();
};

// ---- View ----
const canvas = byId('view'), pen = canvas.getContext('2d');
const eye = { turn: 0.7, tilt: 0.45, zoom: 1 };
let center = [0, 0, 0], size = 1, places = [];
const colorAt = share => data.colors[Math.round(Math.max(0, Math.min(1, share)) * (data.colors.length - 1))];
function frame() {
  const n = bake.nodes, r = Number(byId('region').value);
  const roots = bake.roots[r];
  center = [0, 0, 0], size = 1;
  if (roots.length) {
    const low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
    for (const i of roots) for (let a = 0; a < 3; ++a) {
      const half = n.half ? n.half[3 * i + a] : n.radius[i];
      low[a] = Math.min(low[a], n.center[3 * i + a] - half);
      high[a] = Math.max(high[a], n.center[3 * i + a] + half);
    }
    center = low.map((x, a) => (x + high[a]) / 2);
    size = (n.half ? Math.hypot(...low.map((x, a) => high[a] - x)) : Math.max(...low.map((x, a) => high[a] - x))) / 2 || 1;
  }
  let deepest = 1;
  for (let i = 0; i < bake.count; ++i) if (n.region[i] === r) deepest = Math.max(deepest, n.depth[i]);
  byId('depth').max = deepest;
  setDepth(Math.min(Number(byId('depth').value), deepest));
}
// Turns around a volume, which then fills the view; around all of its space where there is none.
function centre(i) {
  const n = bake.nodes;
  if (i < 0 || n.region[i] !== Number(byId('region').value)) frame();
  else center = [0, 1, 2].map(a => n.center[3 * i + a]), size = n.radius[i] * 1.6 || 1;
  eye.zoom = 1;
  redraw();
}
function setDepth(depth) {
  byId('depth').value = depth;
  byId('depth-shown').textContent = `${byId('depth').value} of ${byId('depth').max}`;
}
function values() {
  const n = bake.nodes, key = byId('color').value;
  if (key !== 'other') return { of: i => key === 'slack' ? n.slack[i] || null : n[key][i], log: key === 'visits' || key === 'cost' };
  return { of: i => n.other[i] === null || n.visits[i] + n.other[i] === 0 ? null : n.other[i] - n.visits[i], log: false };
}
function draw() {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio))
    canvas.width = Math.round(w * ratio), canvas.height = Math.round(h * ratio);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  const n = bake.nodes, r = Number(byId('region').value), depth = Number(byId('depth').value), withLeaves = byId('leaves').checked;
  const [ct, st, cp, sp] = [Math.cos(eye.turn), Math.sin(eye.turn), Math.cos(eye.tilt), Math.sin(eye.tilt)];
  const distance = 3.2;  // of the eye, in radii of what fills the view
  const scale = 0.46 * Math.min(w, h) * eye.zoom * Math.sqrt(distance * distance - 1);
  const project = (x, y, z) => {
    x = (x - center[0]) / size, y = (y - center[1]) / size, z = (z - center[2]) / size;
    const a = ct * x - st * z, b = st * x + ct * z, up = cp * y - sp * b, away = sp * y + cp * b;
    const near = distance - away;
    return near > 0.05 ? [w / 2 + scale * a / near, h / 2 - scale * up / near, near] : null;
  };
  const value = values();
  let low = Infinity, high = -Infinity, list = [];
  for (let i = 0; i < bake.count; ++i) {
    if (n.region[i] !== r || !(n.depth[i] === depth || (withLeaves && n.leaf[i] && n.depth[i] < depth))) continue;
    list.push(i);
    const v = value.of(i);
    if (v !== null) low = Math.min(low, v), high = Math.max(high, v);
  }
  const left = Math.max(0, list.length - kDrawn);
  list = list.slice(0, kDrawn);
  if (chosen >= 0 && n.region[chosen] === r && !list.includes(chosen)) list.push(chosen);
  const amount = v => v === null ? null : high > low ? (value.log ? Math.log1p(v - low) / Math.log1p(high - low) : (v - low) / (high - low)) : 0.5;
  places = [];
  for (const i of list) {
    const at = project(n.center[3 * i], n.center[3 * i + 1], n.center[3 * i + 2]);
    if (at) places.push({ i, x: at[0], y: at[1], near: at[2], radius: Math.max(0.8, scale * n.radius[i] / size / at[2]) });
  }
  places.sort((p, q) => q.near - p.near);
  const many = places.length > 400;
  for (const place of places) drawVolume(place, amount(value.of(place.i)), many, project);
  byId('low').textContent = low <= high ? short(low) : '–';
  byId('high').textContent = low <= high ? short(high) : '–';
  byId('scale').style.background = `linear-gradient(90deg, ${data.colors.join(', ')})`;
  if (left) { pen.fillStyle = getComputedStyle(canvas).color; pen.fillText(`${left} more are not drawn`, 8, h - 8); }
}
function drawVolume({ i, x, y, radius }, share, many, project) {
  const n = bake.nodes, picked = i === chosen;
  pen.strokeStyle = picked ? '#ff5a00' : share === null ? '#8a94a2' : colorAt(share);
  pen.fillStyle = share === null ? '#8a94a2' : colorAt(share);
  pen.lineWidth = picked ? 2.5 : many ? 0.7 : 1.2;
  if (!n.half) {
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.globalAlpha = picked ? 0.3 : many ? 0.16 : 0.11;
    pen.fill();
    pen.globalAlpha = 1;
    pen.stroke();
    return;
  }
  const corner = k => project(...[0, 1, 2].map(a => n.center[3 * i + a] + (k >> a & 1 ? 1 : -1) * n.half[3 * i + a]));
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
  if (corners.includes(null)) return;
  pen.beginPath();
  for (let k = 0; k < 8; ++k) for (let a = 0; a < 3; ++a) if (!(k >> a & 1)) {
    pen.moveTo(corners[k][0], corners[k][1]);
    pen.lineTo(corners[k | 1 << a][0], corners[k | 1 << a][1]);
  }
  pen.stroke();
}
let waiting = false;
function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
}
{
  const fingers = new Map();
  let moved = 0, spread = 0;
  canvas.onpointerdown = event => {
    fingers.set(event.pointerId, event);
    canvas.setPointerCapture(event.pointerId);
    moved = 0, spread = 0;
  };
  canvas.onpointermove = event => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    fingers.set(event.pointerId, event);
    if (fingers.size === 2) {
      const [a, b] = [...fingers.values()];
      const now = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (spread) zoom(now / spread);
      spread = now, moved = 99;
      return;
    }
    const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
    moved += Math.abs(dx) + Math.abs(dy);
    turn(dx * 0.008, dy * 0.008);
  };
  canvas.onpointerup = event => { fingers.delete(event.pointerId); if (moved < 5) pick(event); };
  canvas.onpointercancel = event => fingers.delete(event.pointerId);
}
function turn(dx, dy) { eye.turn += dx; eye.tilt = Math.max(-1.55, Math.min(1.55, eye.tilt + dy)); redraw(); }
function zoom(factor) { eye.zoom = Math.max(0.2, Math.min(60, eye.zoom * factor)); redraw(); }
canvas.ondblclick = () => centre(chosen);
byId('centre').onclick = () => centre(chosen);
byId('whole').onclick = () => centre(-1);
// The smallest volume under the pointer: what is inside others can be reached.
function pick(event) {
  const box = canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
  let best = null;
  for (const place of places)
    if (Math.hypot(place.x - x, place.y - y) <= Math.max(place.radius, 5) && (!best || place.radius < best.radius)) best = place;
  if (best) choose(best.i, 'view');
}
canvas.addEventListener('wheel', event => { event.preventDefault(); zoom(Math.exp(-event.deltaY * 0.0015)); }, { passive: false });
canvas.onkeydown = event => {
  const act = { ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
    'f': () => centre(chosen), 'Home': () => centre(-1),
    '+': () => zoom(1.15), '=': () => zoom(1.15), '-': () => zoom(1 / 1.15), '0': () => { eye.zoom = 1; redraw(); },
    '[': () => { setDepth(Number(byId('depth').value) - 1); redraw(); }, ']': () => { setDepth(Number(byId('depth').value) + 1); redraw(); } }[event.key];
  if (act) { act(); event.preventDefault(); }
};
byId('depth').oninput = () => { setDepth(byId('depth').value); redraw(); };
byId('leaves').onchange = byId('color').onchange = redraw;
byId('region').onchange = () => { frame(); redraw(); };
new ResizeObserver(redraw).observe(canvas);

// ---- All together ----
function showBake(number) {
  bake = data.bakes[number];
  chosen = -1;
  byId('region').replaceChildren(...bake.regions.map((name, r) => make('option', { value: r }, name)));
  byId('region-choice').hidden = bake.regions.length < 2;
  if (bake.roots[0].length === 0 && bake.regions.length > 1) byId('region').value = 1;
  showOutline();
  frame();
  setDepth(Math.min(4, byId('depth').max));
  draw();
}
data.bakes.forEach((b, i) => byId('bake').append(make('option', { value: i }, b.name)));
byId('bake-choice').hidden = data.bakes.length < 2;
byId('bake').onchange = () => showBake(Number(byId('bake').value));
if (!data.alike) byId('color').querySelector('[value="other"]').remove();
for (const button of all('button.go')) {
  button.onclick = () => {
    const wanted = Number(button.dataset.bake);
    if (data.bakes[wanted] !== bake) { byId('bake').value = wanted; showBake(wanted); }
    const n = bake.nodes, i = n.number.findIndex((number, k) => number === Number(button.dataset.node) && n.region[k] === Number(button.dataset.region));
    byId('tree').scrollIntoView();
    if (i >= 0) choose(i, 'table');
    else byId('picked').textContent = 'This node stands deeper than the nodes that this page keeps.';
  };
}
showBake(0);
