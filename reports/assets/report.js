// SPDX-License-Identifier: MIT
// What the report's page does, after page.js: filters, tables of rays built when they are looked at.
// ---- Rays ----
// The packing is described in html_rays.cpp.
const data = JSON.parse(byId('data').textContent);
const kVerdicts = ['agree', 'tie', 'grazing', 'reference_wrong', 'undefined', 'leak', 'tracer_wrong', 'capped'];
const kFields = ['verdict', 'index', 'origin', 'direction', 't_max', 'tracer', 'reference', 'exact', 'reason', 'margin', 'bound', 'replay', 'layer', 'explanation'];
const number = text => text === '' ? NaN : Number(text.replaceAll(',', ''));
function unpack([owner, text, numbers]) {
  const words = numbers.split(' ');
  let next = 0;
  const lines = data.texts[text].replace(/[\u0001\u0004]/g, mark => {
    const word = words[next++];
    return mark === '\u0001' ? word : word.startsWith('-') ? '-0x1.' + word.slice(1) : '0x1.' + word;
  }).split('\n');
  const ray = { owner, name: data.names[owner], id: data.ids[owner] };
  kFields.forEach((field, i) => { ray[field] = lines[i]; });
  ray.replay = ray.replay.replace('\u0002', ray.origin).replace('\u0003', ray.direction);
  ray.ratio = number(ray.margin) / number(ray.bound);
  return ray;
}
const raysOf = new Map();
for (const packed of data.rays) {
  const id = data.ids[packed[0]];
  if (!raysOf.has(id)) raysOf.set(id, []);
  raysOf.get(id).push(packed);
}

// The shortest decimal that is the same 32-bit float, or the same double where it is none.
function shortest(value) {
  if (Object.is(value, -0)) return '-0';
  for (let digits = 1; digits <= 17; ++digits) {
    const near = Number(value.toPrecision(digits));
    if (near === value || (Math.fround(value) === value && Math.fround(near) === value)) return String(near);
  }
  return String(value);
}
// A hex float in decimal.
function decimal(hex) {
  const parts = /^([+-]?)0x([0-9a-f]+)\.?([0-9a-f]*)p([+-]?\d+)$/i.exec(hex.trim());
  if (!parts) return hex;
  const value = (parts[1] === '-' ? -1 : 1) * parseInt(parts[2] + parts[3], 16) * 2 ** (Number(parts[4]) - 4 * parts[3].length);
  return shortest(value);
}
const decimals = text => text.split(',').map(decimal).join(', ');
const verdictOrder = verdict => { const i = kVerdicts.indexOf(verdict); return i < 0 ? kVerdicts.length : i; };
const verdictChip = verdict => make('span', { className: 'chip' },
  make('i', { className: kVerdicts.includes(verdict) ? 'v-' + verdict : 'v-other' }), verdict);

// Lines of a label and a text.
function lines(pairs) {
  const list = make('dl');
  for (const [label, text, title] of pairs) if (text) list.append(make('dt', {}, label), make('dd', { title: title || '' }, text));
  return list;
}
// Lets a dotted name break where it means something.
function breakable(name) {
  const out = document.createDocumentFragment();
  for (const part of name.split(/(?<=[._])/)) out.append(part, make('wbr'));
  return out;
}
const kColumns = [
  { name: 'verdict', key: r => verdictOrder(r.verdict), cell: r => verdictChip(r.verdict) },
  { name: 'case, ray', key: r => r.name + ' ' + r.index, when: o => o.withCase, cell: r => {
    const cell = document.createDocumentFragment();
    const link = make('a', { href: '#' + r.id });
    link.append(breakable(r.name));
    cell.append(link, make('br'), 'ray ' + Number(r.index).toLocaleString('en'));
    return cell;
  } },
  { name: 'ray', number: true, key: r => Number(r.index), when: o => !o.withCase, cell: r => Number(r.index).toLocaleString('en') },
  { name: 'origin, direction, t_max', className: 'mono', cell: (r, hex) => lines([['o', r.origin], ['d', r.direction], ['t', r.t_max]].map(
    ([label, text]) => [label, hex ? text.replaceAll(',', ', ') : decimals(text), hex ? decimals(text) : text])) },
  { name: 'answers', className: 'answers', key: r => r.tracer + r.reference,
    cell: r => lines([['tracer', r.tracer], ['reference', r.reference], ['exact', r.exact]]) },
  { name: 'layer', key: r => r.layer, when: (o, rays) => rays.some(r => r.layer), cell: r => {
    const cell = document.createDocumentFragment();
    if (r.layer) cell.append(make('b', {}, r.layer));
    if (r.explanation) cell.append(make('br'), make('a', { href: r.explanation }, 'explanation'));
    return cell;
  } },
  { name: 'reason', className: 'why', key: r => r.reason, cell: r => r.reason },
  { name: 'margin\u200b/bound', number: true, key: r => r.ratio, when: (o, rays) => rays.some(r => r.bound), cell: r => {
    const cell = document.createDocumentFragment();
    if (r.bound) cell.append((r.ratio || 0).toPrecision(2), make('small', {}, r.margin || '0', make('br'), r.bound));
    return cell;
  } },
  { name: 'replay', cell: r => r.replay ? copyButton(r.replay) : '' },
];
const kPage = 50;

// Fills `mount` with a table of rays that can be sorted and filtered.
function mountRays(mount, packed, options) {
  const rays = packed.map(unpack).filter(r => !options.verdict || r.verdict === options.verdict)
    .sort((a, b) => verdictOrder(b.verdict) - verdictOrder(a.verdict));  // the gravest first
  const columns = kColumns.filter(c => !c.when || c.when(options, rays));
  let sorted = rays, shown = kPage, hex = true;
  const filter = make('input', { type: 'search', placeholder: 'Filter rays', ariaLabel: 'Filter rays' });
  const verdicts = [...new Set(rays.map(r => r.verdict))].sort((a, b) => verdictOrder(a) - verdictOrder(b));
  const select = make('select', { ariaLabel: 'Verdict' }, make('option', { value: '' }, 'all verdicts'),
    ...verdicts.map(v => make('option', { value: v }, `${v} (${rays.filter(r => r.verdict === v).length.toLocaleString('en')})`)));
  const base = make('button', { type: 'button' }, 'Show decimals');
  const count = make('span', { className: 'soft', ariaLive: 'polite' });
  const more = make('button', { type: 'button', className: 'more' }, 'Show more');
  const body = make('tbody');
  const head = make('tr');
  // Narrow windows show no headings to click.
  const order = make('select', { className: 'sort', ariaLabel: 'Order' }, make('option', {}, 'order')), orders = [];
  for (const column of columns) {
    const cell = make('th', { scope: 'col', className: column.number ? 'n' : '' });
    if (column.name === 'verdict' && !options.verdict) cell.setAttribute('aria-sort', 'descending');
    if (column.key) {
      const button = make('button', { type: 'button' }, column.name);
      button.onclick = () => sortBy(column, cell, cell.getAttribute('aria-sort') === 'ascending');
      cell.append(button);
      for (const direction of ['ascending', 'descending']) {
        order.append(make('option', {}, `${column.name}, ${direction}`));
        orders.push(() => sortBy(column, cell, direction === 'descending'));
      }
    } else {
      cell.append(column.name);
    }
    head.append(cell);
  }
  order.onchange = () => orders[order.selectedIndex - 1]?.();
  function sortBy(column, cell, down) {
    for (const other of head.children) other.removeAttribute('aria-sort');
    cell.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    const sign = down ? -1 : 1;
    sorted = [...rays].sort((a, b) => {
      const x = column.key(a), y = column.key(b);
      if (typeof x === 'string') return sign * x.localeCompare(y, 'en', { numeric: true });
      if (Number.isNaN(x) || Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);  // what has no number comes last
      return sign * (x - y);
    });
    draw();
  }
  function draw() {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const kept = sorted.filter(r => (!select.value || r.verdict === select.value) &&
      words.every(w => (kFields.map(f => r[f]).join(' ') + ' ' + r.name).toLowerCase().includes(w)));
    body.replaceChildren(...kept.slice(0, shown).map(ray => {
      const row = make('tr');
      for (const column of columns) {
        const cell = make('td', { className: column.number ? 'n' : column.className || '' });
        cell.append(column.cell(ray, hex));
        if (cell.textContent) cell.dataset.name = column.name;
        row.append(cell);
      }
      return row;
    }));
    count.textContent = kept.length === 1 ? '1 ray' : kept.length.toLocaleString('en') + ' rays';
    more.hidden = kept.length <= shown;
  }
  filter.oninput = select.onchange = () => { shown = kPage; draw(); };
  base.onclick = () => { hex = !hex; base.textContent = hex ? 'Show decimals' : 'Show hex floats'; draw(); };
  more.onclick = () => { shown += 4 * kPage; draw(); };
  const tools = make('div', { className: 'tools' }, filter);
  if (verdicts.length > 1) tools.append(select);
  tools.append(order, base, count);
  const scroll = make('div', { className: 'scroll', tabIndex: 0, role: 'region', ariaLabel: 'Rays' },
    make('table', { className: 'raytable' }, make('thead', {}, head), body));
  mount.append(tools, scroll, more);
  draw();
}

// Built when it comes near the window, or when its case is opened: the page itself opens at once.
const soon = new IntersectionObserver(entries => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    soon.unobserve(target);
    const owner = target.closest('.case');
    if (owner) mountRays(target, raysOf.get(owner.id) || [], {});
    else mountRays(target, data.rays, { withCase: true, verdict: target.dataset.verdict });
  }
}, { rootMargin: '400px' });
for (const mount of all('.rays')) soon.observe(mount);

// ---- Cases ----
const cases = all('.case');
if (byId('case-tools')) {
  const filter = make('input', { type: 'search', placeholder: 'Filter cases by name or text', ariaLabel: 'Filter cases' });
  const count = make('span', { className: 'soft', ariaLive: 'polite' });
  const states = ['passed', 'failed', 'error', 'skipped'].filter(s => cases.some(c => c.classList.contains('s-' + s)));
  const select = make('select', { ariaLabel: 'Status' }, make('option', { value: '' }, 'all'), ...states.map(s => make('option', { value: s }, s)));
  // A cell of a matrix narrows the list to its cases.
  let texts, cell = {};
  const axesOf = c => ({ feature: c.closest('.group').dataset.feature, ...c.dataset });
  const within = c => { const axes = axesOf(c); return Object.entries(cell).every(([name, value]) => axes[name] === value); };
  const draw = () => {
    texts ||= cases.map(c => c.textContent.toLowerCase());
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    let kept = 0;
    cases.forEach((c, i) => {
      c.hidden = !(within(c) && (!select.value || c.classList.contains('s-' + select.value)) && words.every(w => texts[i].includes(w)));
      kept += !c.hidden;
    });
    for (const group of all('.group')) group.hidden = !group.querySelector('.case:not([hidden])');
    count.textContent = kept === cases.length ? '' : `${kept} of ${cases.length}`;
  };
  filter.oninput = select.onchange = draw;
  const whole = make('button', { type: 'button', className: 'whole', hidden: true });
  const narrow = chosen => {
    cell = chosen;
    const what = Object.values(cell).map(value => value || 'no scene').join(', ');
    whole.hidden = !what;
    whole.textContent = `${what} ✕`;
    whole.ariaLabel = `Only ${what}: show all cases`;
    filter.value = select.value = '';
    draw();
  };
  whole.onclick = () => narrow({});
  for (const [section, row] of [['#matrix', 'feature'], ['#families', 'family']]) {
    for (const link of all(`${section} td a`)) {
      link.title = link.ariaLabel;
      link.addEventListener('click', () => {
        const axes = axesOf(byId(decodeURIComponent(link.hash.slice(1))));
        narrow({ [row]: axes[row], scene: axes.scene });
      });
    }
  }
  const open = make('button', { type: 'button' }, 'Open failed');
  open.onclick = () => { for (const c of cases) c.open = !c.hidden && (c.classList.contains('s-failed') || c.classList.contains('s-error')); };
  const close = make('button', { type: 'button' }, 'Close all');
  close.onclick = () => { for (const c of cases) c.open = false; };
  const tools = byId('case-tools');
  tools.className = 'tools';
  tools.append(filter);
  if (states.length > 1) tools.append(select);
  if (states.includes('failed') || states.includes('error')) tools.append(open);
  tools.append(close, whole, count);
}
// A link to a case opens it, also where a filter hides it.
function follow() {
  const target = byId(decodeURIComponent(location.hash.slice(1)));
  if (!target || !target.classList.contains('case')) return;
  target.hidden = target.closest('.group').hidden = false;
  target.open = true;
  target.scrollIntoView();
  target.querySelector('summary').focus({ preventScroll: true });
}
addEventListener('hashchange', follow);
document.addEventListener('click', event => {
  const summary = event.target.closest('.case > summary');
  if (summary) history.replaceState(null, '', '#' + summary.parentElement.id);  // the address always leads to the case last opened
  const link = event.target.closest('a[href^="#case-"]');
  if (link && link.hash === location.hash) follow();  // a second click changes no address
});
follow();
addEventListener('beforeprint', () => { for (const c of cases) if (c.classList.contains('s-failed')) c.open = true; });
