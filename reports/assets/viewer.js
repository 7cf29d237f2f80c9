// SPDX-License-Identifier: MIT
// The picture viewer of the report's page, after report.js: two pictures of a case that show the same pixels, flipped or
// on both sides of a slider, down to single pixels with the values of all of them.

// Values come from scripts beside the pictures (reports/pixel_values.h): a page opened from a disk may load nothing else.
const valuesOf = new Map();
globalThis.plumbline_values = file => {
  const bytes = Uint8Array.from(atob(file.float32), c => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const floats = Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
  valuesOf.set(file.picture, { ...file, floats });
};
function loadValues(picture, done) {
  const { values, path } = picture.dataset;
  if (!values || valuesOf.has(path)) return;
  valuesOf.set(path, null);  // on its way
  document.head.append(make('script', { src: values, onload: done, onerror: () => { valuesOf.set(path, 'missing'); done(); } }));
}
// What is known of a pixel: cells of a table's row after its heading.
function valuesAt(picture, x, y) {
  const file = valuesOf.get(picture.dataset.path);
  if (file === 'missing') return { why: 'its file of values is not beside this page' };
  if (!picture.dataset.values) return { why: picture.getAttribute('width') * picture.getAttribute('height') > 128 * 128
    ? 'only its colour is known: values are kept up to 128 × 128 pixels' : 'its colours are no values' };
  if (!file) return { why: 'values are being loaded' };
  const n = file.channels.length, at = n * (y * file.width + x);
  const numbers = file.floats.slice(at, at + n);
  if (file.kinds.length) return { cells: [file.kinds[numbers[0]] ?? 'unknown'], names: [''], unit: '' };
  return { cells: numbers.map(shortest), names: file.channels, unit: file.unit };
}

{
  const dialog = byId('viewer'), stage = dialog.querySelector('.stage');
  const sides = { a: stage.querySelector('.a'), b: stage.querySelector('.b') };
  const selects = { a: dialog.querySelector('[data-of=a]'), b: dialog.querySelector('[data-of=b]') };
  const cursor = stage.querySelector('.cursor'), edge = stage.querySelector('.edge');
  const split = dialog.querySelector('.split'), range = split.querySelector('input');
  const output = dialog.querySelector('output'), table = dialog.querySelector('.values'), shown = dialog.querySelector('.shown');
  const button = Object.fromEntries(all('button[data-do]', dialog).map(b => [b.dataset.do, b]));
  let list = [], chosen = { a: 0, b: 0 }, flipped = false, sliding = false, pixel = null;
  let width = 1, height = 1, zoom = 1, left = 0, top = 0, drag = null, fitted = true;

  const front = () => (flipped && !sliding ? 'b' : 'a');
  const source = side => list[chosen[side]];
  const seen = () => (sliding ? ['a', 'b'] : [front()]);
  function place() {
    for (const image of Object.values(sides)) {
      image.style.transform = `translate(${left}px, ${top}px) scale(${zoom})`;
      image.style.imageRendering = zoom > 1 ? 'pixelated' : 'auto';
    }
    const at = stage.clientWidth * range.value / 100;
    edge.style.left = `${at}px`;
    edge.hidden = !sliding;
    // Clipping is in the picture's own pixels, before it is scaled.
    sides.a.style.clipPath = sliding ? `inset(0 ${Math.max(0, width - (at - left) / zoom)}px 0 0)` : '';
    sides.b.style.clipPath = sliding ? `inset(0 0 0 ${Math.max(0, (at - left) / zoom)}px)` : '';
    sides.a.hidden = !sliding && flipped;
    sides.b.hidden = !sliding && !flipped;
    cursor.hidden = !pixel;
    if (pixel) Object.assign(cursor.style, { left: `${left + zoom * pixel[0]}px`, top: `${top + zoom * pixel[1]}px`, width: `${zoom}px`, height: `${zoom}px` });
  }
  function fit() {
    const { clientWidth: w, clientHeight: h } = stage;
    const exact = Math.min(w / width, h / height);
    zoom = exact >= 1 ? Math.floor(exact) : exact;  // whole pixels stay square
    left = Math.round((w - zoom * width) / 2);
    top = Math.round((h - zoom * height) / 2);
    fitted = true;
    place();
  }
  function tell() {
    const one = list.length < 2;
    for (const name of ['flip', 'slide']) button[name].disabled = one;
    button.flip.setAttribute('aria-pressed', String(flipped));
    button.slide.setAttribute('aria-pressed', String(sliding));
    split.hidden = !sliding;
    shown.replaceChildren(...seen().map(side => {
      const caption = source(side).closest('figure').querySelector('figcaption').cloneNode(true);
      caption.prepend(make('span', { className: 'side' }, side.toUpperCase()), ' ');
      const block = make('div', {});
      block.append(...caption.childNodes);
      return block;
    }));
    describe();
  }
  function describe() {
    const command = source(front()).dataset.explain;
    button.explain.hidden = !pixel || !command;
    output.textContent = pixel ? `x ${pixel[0]}, y ${pixel[1]}` : 'none chosen';
    if (!pixel) return table.replaceChildren();
    table.replaceChildren(make('table', {}, make('tbody', {}, ...list.map((picture, i) => {
      const marks = ['a', 'b'].filter(side => chosen[side] === i && (side === 'a' || list.length > 1)).map(side => side.toUpperCase()).join(' ');
      const row = make('tr', {}, make('th', { scope: 'row' }, make('span', { className: marks ? 'side' : '' }, marks), ` ${picture.alt}`));
      const known = valuesAt(picture, ...pixel);
      const cell = make('td', { className: known.why ? 'soft' : 'numbers' });
      if (known.why) cell.append(known.why);
      else known.cells.forEach((text, k) => cell.append(make('span', {}, make('small', {}, known.names[k]), ` ${text}`)));
      if (known.unit) cell.append(make('small', { className: 'soft' }, known.unit));
      row.append(cell);
      return row;
    }))));
  }
  function show(side, index) {
    chosen[side] = (index + list.length) % list.length;
    selects[side].value = String(chosen[side]);
    sides[side].src = source(side).src;
    sides[side].alt = source(side).alt;
    place();
    tell();
  }
  function choose(x, y) {
    pixel = [Math.min(width - 1, Math.max(0, x)), Math.min(height - 1, Math.max(0, y))];
    place();
    describe();
  }
  function scale(factor, x, y) {
    if (x === undefined) [x, y] = pixel ? [left + zoom * (pixel[0] + 0.5), top + zoom * (pixel[1] + 0.5)] : [stage.clientWidth / 2, stage.clientHeight / 2];
    const next = Math.min(64, Math.max(0.1, zoom * factor));
    left = x - (x - left) * next / zoom;
    top = y - (y - top) * next / zoom;
    zoom = next;
    fitted = false;
    place();
  }
  const under = event => {
    const box = stage.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left - left) / zoom), y = Math.floor((event.clientY - box.top - top) / zoom);
    return x >= 0 && y >= 0 && x < width && y < height ? [x, y] : null;
  };
  const steps = {
    flip: () => { if (list.length < 2) return; sliding = false; flipped = !flipped; place(); tell(); },
    slide: () => { if (list.length < 2) return; sliding = !sliding; tell(); place(); },
    in: () => scale(2), out: () => scale(0.5), fit,
    explain: () => copy(`${source(front()).dataset.explain} ${pixel.join(',')}`, button.explain),
    close: () => dialog.close(),
  };
  for (const [name, element] of Object.entries(button)) element.onclick = steps[name];
  for (const side of ['a', 'b']) selects[side].onchange = () => show(side, Number(selects[side].value));
  range.oninput = place;
  dialog.addEventListener('keydown', event => {
    if (event.target.matches('select, input') || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = { f: 'flip', F: 'flip', s: 'slide', S: 'slide', '+': 'in', '=': 'in', '-': 'out', 0: 'fit' }[event.key];
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const turn = { PageUp: -1, PageDown: 1 }[event.key];
    if (!step && !move && !turn) return;
    event.preventDefault();
    if (step) steps[step]();
    if (turn) show('a', chosen.a + turn);
    if (!move) return;
    const far = event.shiftKey ? 10 : 1;
    if (pixel) choose(pixel[0] + far * move[0], pixel[1] + far * move[1]);
    else choose(width >> 1, height >> 1);
  });
  stage.addEventListener('wheel', event => {
    event.preventDefault();
    const box = stage.getBoundingClientRect();
    scale(event.deltaY < 0 ? 1.25 : 0.8, event.clientX - box.left, event.clientY - box.top);
  }, { passive: false });
  stage.onpointerdown = event => { drag = { x: event.clientX, y: event.clientY, left, top, moved: false }; stage.setPointerCapture(event.pointerId); };
  stage.onpointermove = event => {
    if (!drag) return;
    drag.moved ||= Math.abs(event.clientX - drag.x) + Math.abs(event.clientY - drag.y) > 4;
    if (!drag.moved) return;
    left = drag.left + event.clientX - drag.x;
    top = drag.top + event.clientY - drag.y;
    fitted = false;
    place();
  };
  stage.onpointerup = event => {
    const found = drag && !drag.moved && under(event);
    drag = null;
    if (found) choose(...found);
  };
  stage.onpointercancel = () => { drag = null; };
  // The room changes with the window, and with what is told below the picture.
  new ResizeObserver(() => { if (dialog.open) (fitted ? fit : place)(); }).observe(stage);

  function open(pictures, a, b, name) {
    list = pictures;
    flipped = sliding = false;
    pixel = null;
    width = Number(pictures[a].getAttribute('width')) || pictures[a].naturalWidth || 1;
    height = Number(pictures[a].getAttribute('height')) || pictures[a].naturalHeight || 1;
    byId('viewer-case').textContent = name;
    for (const image of Object.values(sides)) Object.assign(image, { width, height });
    for (const side of ['a', 'b'])
      selects[side].replaceChildren(...list.map((picture, i) => make('option', { value: String(i) }, picture.alt)));
    dialog.classList.toggle('single', list.length < 2);
    for (const picture of list) loadValues(picture, describe);
    dialog.showModal();
    chosen = { a, b };
    show('a', a);
    show('b', b);
    fit();
    stage.focus();
  }

  for (const figures of all('.pictures')) {
    const pictures = all('img', figures);
    const size = picture => `${picture.getAttribute('width')} ${picture.getAttribute('height')}`;
    const isPlot = picture => /(^data:image\/svg|\.svg$)/.test(picture.getAttribute('src'));
    const belong = picture => pictures.filter(other => other === picture || (!isPlot(picture) && !isPlot(other) && size(other) === size(picture)));
    const name = figures.closest('.case').querySelector('.name').textContent;
    const view = picture => {
      const group = belong(picture), at = group.indexOf(picture);
      open(group, at, (at === 1 ? 0 : Math.min(1, group.length - 1)), name);
    };
    for (const picture of pictures) {
      picture.tabIndex = 0;
      picture.setAttribute('role', 'button');
      picture.setAttribute('aria-haspopup', 'dialog');
      picture.onclick = () => view(picture);
      picture.onkeydown = event => { if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); view(picture); } };
    }
    // One button for each set that shows the same pixels.
    const first = pictures.filter(picture => belong(picture)[0] === picture && belong(picture).length > 1);
    if (first.length === 0) continue;
    const bar = make('div', { className: 'tools compare' });
    for (const picture of first) {
      const element = make('button', { type: 'button' }, `Compare ${belong(picture).map(p => p.alt).slice(0, 2).join(' and ')}`);
      element.onclick = () => view(picture);
      bar.append(element);
    }
    bar.append(make('span', { className: 'soft' }, 'flip, slider, values of single pixels'));
    figures.before(bar);
  }
}
