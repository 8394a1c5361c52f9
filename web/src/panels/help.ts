// The overlay that lists every shortcut.

import type { Shortcut } from '../shortcuts';
import { h } from './html';

const GROUPS: Record<Shortcut['group'], string> = {
  tool: 'Tool',
  view: 'View',
  bed: 'Bed',
  time: 'Time',
  page: 'Page',
};

export class Help {
  readonly element: HTMLDialogElement;

  constructor(shortcuts: Shortcut[], about: () => string) {
    const sections = Object.entries(GROUPS).map(([group, title]) =>
      h(
        'section',
        {},
        h('h3', {}, title),
        h(
          'dl',
          {},
          ...shortcuts
            .filter((shortcut) => shortcut.group === group && shortcut.shown !== '')
            .map((shortcut) =>
              h(
                'div',
                {},
                h('dt', {}, shortcut.shown ?? shortcut.keys.join(' ').toUpperCase()),
                h('dd', {}, shortcut.label),
              ),
            ),
        ),
      ),
    );
    const version = h('p', { class: 'help-about' });
    this.element = h(
      'dialog',
      { class: 'help', 'aria-labelledby': 'help-title' },
      h(
        'div',
        { class: 'help-head' },
        h('h2', { id: 'help-title' }, 'How to dig'),
        h('button', { class: 'icon-button', 'aria-label': 'Close help', onclick: () => this.element.close() }, '✕'),
      ),
      h('div', { class: 'help-body' }, ...sections),
      version,
    );
    this.element.addEventListener('click', (event) => {
      if (event.target === this.element) this.element.close();
    });
    this.element.addEventListener('toggle', () => (version.textContent = about()));
  }

  toggle(): void {
    if (this.element.open) this.element.close();
    else this.element.showModal();
  }
}
