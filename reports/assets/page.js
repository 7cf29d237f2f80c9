// SPDX-License-Identifier: MIT
// What all pages do: theme, copy buttons.
'use strict';
const byId = id => document.getElementById(id);
const all = (selector, root = document) => [...root.querySelectorAll(selector)];
const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

// ---- Theme ----
{
  const button = byId('theme');
  const states = ['auto', 'light', 'dark'];
  const current = () => document.documentElement.dataset.theme || 'auto';
  const show = () => { button.textContent = { auto: '◐ Auto', light: '☀ Light', dark: '☾ Dark' }[current()]; };
  button.onclick = () => {
    const next = states[(states.indexOf(current()) + 1) % 3];
    if (next === 'auto') delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = next;
    try { localStorage.setItem('plumbline-theme', next); } catch { /* storage may be closed to files */ }
    show();
  };
  button.hidden = false;
  show();
}

// ---- Copying ----
async function copy(text, button) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {  // pages opened from a disk may lack the clipboard
    const area = make('textarea', { value: text });
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
  const before = button.textContent;
  button.textContent = 'Copied';
  byId('said').textContent = 'Copied';
  setTimeout(() => { button.textContent = before; byId('said').textContent = ''; }, 1200);
}
const copyButton = (text, label = 'Copy') => {
  const button = make('button', { type: 'button', className: 'copy', title: text }, label);
  button.onclick = () => copy(text, button);
  return button;
};
for (const box of all('.cmd')) box.append(copyButton(box.textContent));
