// Notes of the experimenter and the program, newest first, and a line for the next one.

import type { Note } from 'haptolith-protocol';
import { h } from '../panels/html';

const LONGEST_NOTE = 2000;

export class NotesPanel {
  readonly element: HTMLElement;
  private readonly list = h('ul', { class: 'scroller', tabindex: '0' });
  private readonly input = h('input', {
    type: 'text',
    placeholder: 'Write a note',
    'aria-label': 'Note',
    maxlength: LONGEST_NOTE,
  });
  private shown = '';

  /** @param write  resolves when the note is stored; until then the text is kept in its line. */
  constructor(write: (text: string) => Promise<void>) {
    const form = h('form', { class: 'note-form' }, this.input, h('button', { type: 'submit' }, 'Add'));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const text = this.input.value.trim();
      if (text === '') return;
      write(text).then(
        () => (this.input.value = ''),
        () => this.input.focus(),
      );
    });
    this.element = h(
      'section',
      { class: 'card notes-card', 'aria-label': 'Notes' },
      h('h2', {}, 'Notes'),
      form,
      this.list,
    );
  }

  focus(): void {
    this.input.focus();
  }

  set(notes: readonly Note[]): void {
    const shown = JSON.stringify(notes);
    if (shown === this.shown) return;
    this.shown = shown;
    this.list.replaceChildren(
      ...notes
        .map(({ at, kind, text }) =>
          h(
            'li',
            {},
            h('time', { datetime: at, class: 'unit numbers' }, timeOfDay(at)),
            kind !== 'note' && h('span', { class: 'kind' }, kind),
            h('span', {}, text),
          ),
        )
        .reverse(),
    );
  }
}

/** Formats a time in UTC as local hours and minutes. */
function timeOfDay(at: string): string {
  const date = new Date(at);
  return Number.isNaN(date.getTime())
    ? at
    : date.toLocaleTimeString('en-GB', { hour: '2-digit', minute: '2-digit', second: '2-digit' });
}
