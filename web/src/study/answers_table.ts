// The answers so far, newest first.

import { fixed, h } from '../panels/html';
import type { Answer } from './protocol';

export class AnswersTable {
  readonly element: HTMLElement;
  private readonly rows = h('tbody', {});
  private readonly nothing = h('p', { class: 'nothing' }, 'No answers yet.');
  private shown = '';

  constructor() {
    const heads = ['trial', 'block', 'test', 'said', 'right', 'time, s'];
    this.element = h(
      'section',
      { class: 'card answers-card', 'aria-label': 'Answers so far' },
      h('h2', {}, 'Answers'),
      h(
        'div',
        { class: 'scroller', tabindex: '0' },
        h('table', {}, h('thead', {}, h('tr', {}, ...heads.map((head) => h('th', { scope: 'col' }, head)))), this.rows),
        this.nothing,
      ),
    );
  }

  set(trials: readonly Answer[]): void {
    const answers = trials.filter(({ state }) => state !== 'begun');
    const shown = JSON.stringify(answers);
    if (shown === this.shown) return;
    this.shown = shown;
    this.rows.replaceChildren(...answers.map(row).reverse());
    this.nothing.hidden = answers.length > 0;
  }
}

function row(answer: Answer): HTMLElement {
  const { state, reason, kind } = answer;
  const remark = state === 'answered' ? (kind === 'main' ? '' : kind) : reason ? `${state}: ${reason}` : state;
  const said = answer.positive === null ? '–' : answer.positive ? 'more' : 'less';
  const right =
    answer.correct === null
      ? h('td', {}, '–')
      : h(
          'td',
          { class: answer.correct ? 'good' : 'bad', 'aria-label': answer.correct ? 'right' : 'wrong' },
          answer.correct ? '✓' : '✕',
        );
  return h(
    'tr',
    { class: state },
    h('td', { class: 'numbers' }, String(answer.trial)),
    h('td', {}, answer.block, remark && h('small', { title: remark }, remark)),
    h('td', {}, answer.test, h('span', { class: 'unit numbers' }, ` ${String(Number(answer.value.toPrecision(4)))}`)),
    h('td', {}, said),
    right,
    h('td', { class: 'numbers' }, answer.reaction_s === null ? '–' : fixed(answer.reaction_s, 1, 4)),
  );
}
