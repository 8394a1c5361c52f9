// The responses so far, newest first.

import type { Answer } from 'haptolith-protocol';
import { fixed, h } from '../panels/html';

export class AnswersTable {
  readonly element: HTMLElement;
  private readonly heads = h('tr', {});
  private readonly rows = h('tbody', {});
  private readonly nothing = h('p', { class: 'nothing' }, 'No responses yet.');
  private shown = '';

  constructor() {
    this.element = h(
      'section',
      { class: 'card answers-card', 'aria-label': 'Responses so far' },
      h('h2', {}, 'Responses'),
      h(
        'div',
        { class: 'scroller', tabindex: '0' },
        h('table', {}, h('thead', {}, this.heads), this.rows),
        this.nothing,
      ),
    );
  }

  /** Shows the responses; `blinded`: neither the stimulus nor whether it was right. */
  set(trials: readonly Answer[], blinded: boolean): void {
    const answers = trials.filter(({ state }) => state !== 'begun');
    const shown = JSON.stringify([answers, blinded]);
    if (shown === this.shown) return;
    this.shown = shown;
    const heads = blinded ? ['trial', 'block', 'time, s'] : ['trial', 'block', 'test', 'said', 'right', 'time, s'];
    this.heads.replaceChildren(...heads.map((head) => h('th', { scope: 'col' }, head)));
    this.rows.replaceChildren(...answers.map((answer) => row(answer, blinded)).reverse());
    this.nothing.hidden = answers.length > 0;
  }
}

function row(answer: Answer, blinded: boolean): HTMLElement {
  const { state, reason, kind } = answer;
  // A catch trial can be recognised by its stimulus.
  const told_kind = kind === 'main' || (blinded && kind === 'catch') ? '' : kind;
  const remark = state === 'answered' ? told_kind : reason ? `${state}: ${reason}` : state;
  const { work } = answer;
  const said = work ? workInWords(work) : answer.positive === null ? '–' : answer.positive ? 'more' : 'less';
  const time_s = work ? work.time_s : answer.reaction_s;
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
    !blinded &&
      h('td', {}, answer.test, h('span', { class: 'unit numbers' }, ` ${String(Number(answer.value.toPrecision(4)))}`)),
    !blinded && h('td', {}, said),
    !blinded && right,
    h('td', { class: 'numbers' }, time_s === null ? '–' : fixed(time_s, 1, 4)),
  );
}

/** Formats the result of work: "done, force 51 % off". */
function workInWords({ done, force_error }: NonNullable<Answer['work']>): string {
  const off = force_error === null ? '' : `, force ${(100 * force_error).toFixed(0)} % off`;
  return (done ? 'done' : 'not done') + off;
}
