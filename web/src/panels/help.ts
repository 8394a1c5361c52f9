// The overlay that lists what mouse, fingers and keys do.

import type { Shortcut } from '../shortcuts';
import { h } from './html';

const GROUPS: Record<Shortcut['group'], string> = {
  touch: 'Touch screen',
  tool: 'Tool, by mouse and keys',
  view: 'View',
  bed: 'Bed',
  time: 'Time',
  page: 'Page',
};

export class Help {
  readonly element: HTMLDialogElement;

  constructor(shortcuts: Shortcut[], about: () => string) {
    // Where there is no touch screen, its part comes last.
    const groups = Object.entries(GROUPS);
    if (!matchMedia('(any-pointer: coarse)').matches) groups.push(groups.shift()!);
    const sections = groups.map(([group, title]) =>
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
    const version = h('span', {});
    const licences = h(
      'a',
      { href: './licences.txt', target: '_blank', rel: 'noopener' },
      'Licences of what it is made of',
    );
    this.element = h(
      'dialog',
      { class: 'help', 'aria-labelledby': 'help-title' },
      h(
        'div',
        { class: 'help-head' },
        h('h2', { id: 'help-title' }, 'Mouse, touch and keys'),
        h('button', { class: 'icon-button', 'aria-label': 'Close help', onclick: () => this.element.close() }, '✕'),
      ),
      h('div', { class: 'help-body' }, ...sections),
      h('p', { class: 'help-about' }, version, ' · ', licences),
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
