// The current or next trial: block, reference and test, in the order of their intervals.

import type { TrialKind, TrialShown } from 'haptolith-protocol';
import { h } from '../panels/html';

const KINDS: Record<TrialKind, string> = { practice: 'practice', main: 'main trial', catch: 'catch trial' };

export function trialCard(trial: TrialShown | null, nothing: string): HTMLElement[] {
  if (!trial) return [h('p', { class: 'nothing' }, nothing)];
  const reference = { what: 'reference', name: trial.reference, value: '' };
  const test = { what: 'test', name: trial.test, value: String(Number(trial.value.toPrecision(4))) };
  const order = trial.test_first ? [test, reference] : [reference, test];
  return [
    h(
      'p',
      { class: 'trial-head' },
      h('span', { class: `kind ${trial.kind}` }, KINDS[trial.kind]),
      h('strong', {}, trial.block),
    ),
    h(
      'ol',
      { class: 'stimuli' },
      ...order.map(({ what, name, value }, i) =>
        h(
          'li',
          { class: trial.interval === i + 1 ? 'now' : null, 'aria-current': trial.interval === i + 1 ? 'step' : null },
          h('span', { class: 'unit' }, `${i + 1} · ${what}`),
          h('strong', {}, name),
          value && h('span', { class: 'unit numbers' }, value),
        ),
      ),
    ),
    h('p', { class: 'unit trial-question' }, trial.question),
  ];
}
