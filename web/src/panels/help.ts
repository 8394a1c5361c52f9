// The help overlay: purpose of the page, first exercises, and actions of mouse, fingers and keys.

import type { Shortcut } from '../shortcuts';
import { h } from './html';

const WHAT =
  'haptolith computes granular soil a thousand times a second, so that a hand at a haptic device feels what a tool meets in it. ' +
  'Without a device the mouse, a finger or keys move the tool, and the page shows the force.';

/** The exercises of docs/tutorials/first-hour.md, shortened. */
const EXERCISES = [
  'Press the shovel straight down: the force rises with depth. Pull it out: cohesion holds it for a moment.',
  'Choose Earth as the body: the same soil weighs six times as much as on the Moon.',
  'Go back to the Moon and choose dry sand, which has no cohesion. Dig a hole: its sides slide in. In lunar soil they stand.',
  'Take the jaws, and lift a handful of soil.',
];

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
    // Without a touch screen, and except on phones, the group on touch comes last.
    const groups = Object.entries(GROUPS);
    if (!matchMedia('(any-pointer: coarse), (max-width: 760px)').matches) groups.push(groups.shift()!);
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
        h('h2', { id: 'help-title' }, 'haptolith'),
        h('button', { class: 'icon-button', 'aria-label': 'Close help', onclick: () => this.element.close() }, '✕'),
      ),
      h(
        'div',
        { class: 'help-scroll', tabindex: 0, role: 'region', 'aria-label': 'What this is, and what keys do' },
        h('p', {}, WHAT),
        h('h3', {}, 'Try first'),
        h('ol', {}, ...EXERCISES.map((exercise) => h('li', {}, exercise))),
        h('div', { class: 'help-body' }, ...sections),
      ),
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
