import type { BlockResult, Field } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { readSettings } from '../../src/settings';
import { clockText, Countdown } from '../../src/study/countdown';
import { isTooLong, scaleStep, wholeSteps } from '../../src/study/form';
import { OneAct } from '../../src/study/one_act';
import { linearTicks, logTicks, makeScale } from '../../src/study/plot_scale';
import { splitParagraphs } from '../../src/study/prompts';
import { boundsOf, isLog, pointRadius, shareAt } from '../../src/study/psychometric_plot';
import { asSentence, shareDone, waiting, whatIsShown } from '../../src/study/shown';

describe('the page', () => {
  it('is the one that the address asks for', () => {
    expect(readSettings('?study=participant', false).study).toBe('participant');
    expect(readSettings('?token=abc&study=experimenter', false).study).toBe('experimenter');
    expect(readSettings('?study=cat', false).study).toBeNull();
    expect(readSettings('', false).study).toBeNull();
  });
});

describe('an act', () => {
  const clock = { ms: 1000 };
  const act = new OneAct(() => clock.ms);

  it('counts once, not in the first 200 ms, and again when something else is shown', () => {
    act.renew();
    clock.ms += 199;
    expect(act.take()).toBe(false);
    clock.ms += 1;
    expect(act.take()).toBe(true);
    expect(act.take()).toBe(false);
    act.renew();
    clock.ms += 200;
    expect(act.take()).toBe(true);
  });

  it('does not count just after something was in front of what is shown', () => {
    act.renew();
    clock.ms += 5000;
    act.settle();
    expect(act.take()).toBe(false);
    clock.ms += 200;
    expect(act.take()).toBe(true);
    act.settle();
    clock.ms += 200;
    expect(act.take()).toBe(false);
  });

  it('may be tried again when it did not reach the program', () => {
    act.renew();
    clock.ms += 500;
    expect(act.take()).toBe(true);
    act.giveBack();
    expect(act.take()).toBe(true);
  });
});

describe('a countdown', () => {
  it('runs down between messages and never below zero', () => {
    const clock = { ms: 0 };
    const countdown = new Countdown(() => clock.ms);
    expect(countdown.remaining_s).toBeNull();
    countdown.begin(10);
    clock.ms = 4000;
    expect(countdown.remaining_s).toBeCloseTo(6);
    expect(countdown.share).toBeCloseTo(0.6);
    countdown.set(5);
    clock.ms = 5000;
    expect(countdown.remaining_s).toBeCloseTo(4);
    expect(countdown.share).toBeCloseTo(0.4);
    clock.ms = 60_000;
    expect(countdown.remaining_s).toBe(0);
    countdown.begin(null);
    expect(countdown.remaining_s).toBeNull();
    expect(countdown.share).toBe(0);
  });

  it('is written in whole seconds, rounded up', () => {
    expect(clockText(0)).toBe('0 s');
    expect(clockText(0.1)).toBe('1 s');
    expect(clockText(59.5)).toBe('1:00');
    expect(clockText(125)).toBe('2:05');
  });
});

describe('what is shown', () => {
  const question = { ...waiting(''), phase: 'question' as const, title: 'Which?', remaining_s: 5 };

  it('is the same while only time runs down', () => {
    expect(whatIsShown({ ...question, remaining_s: 4, problem: 'x' })).toBe(whatIsShown(question));
    expect(whatIsShown({ ...question, title: 'What?' })).not.toBe(whatIsShown(question));
    expect(whatIsShown({ ...question, progress: { block: 1, blocks: 2, trial: 4, trials: 15 } })).not.toBe(
      whatIsShown(question),
    );
  });

  it('has paragraphs with blank lines between them', () => {
    expect(splitParagraphs('one\nstill one\n \n\ntwo\n')).toEqual(['one\nstill one', 'two']);
    expect(splitParagraphs('')).toEqual([]);
  });

  it('has the words of the program as sentences', () => {
    expect(asSentence('no study is running')).toBe('No study is running.');
    expect(asSentence('The disk is full!')).toBe('The disk is full!');
    expect(asSentence('')).toBe('');
  });

  it('tells how much of the study is done', () => {
    expect(shareDone(null)).toBe(0);
    expect(shareDone({ block: 1, blocks: 2, trial: 0, trials: 10 })).toBe(0);
    expect(shareDone({ block: 2, blocks: 2, trial: 6, trials: 10 })).toBe(0.75);
    expect(shareDone({ block: 2, blocks: 2, trial: 30, trials: null })).toBe(0.5);
  });
});

describe('a form', () => {
  it('is sent only when it fits into a message', () => {
    expect(isTooLong({ remarks: 'x'.repeat(15_000) })).toBe(false);
    expect(isTooLong({ remarks: 'x'.repeat(16_400) })).toBe(true);
    expect(isTooLong({ remarks: '\u2603'.repeat(6000) })).toBe(true);
  });
});

describe('a scale of a form', () => {
  const scale = (low: number, high: number) => ({ kind: 'scale', low, high }) as Field;

  it('has a button for each value when there are few, else marks like NASA-TLX', () => {
    expect(wholeSteps(scale(1, 7))?.map(([value]) => value)).toEqual(['1', '2', '3', '4', '5', '6', '7']);
    expect(wholeSteps(scale(0, 10))).toHaveLength(11);
    expect(wholeSteps(scale(0, 100))).toBeNull();
    expect(wholeSteps(scale(0, 0.5))).toBeNull();
    expect(scaleStep(scale(0, 100))).toBe(5);
  });
});

describe('an axis', () => {
  it('has marks at round values', () => {
    expect(linearTicks(0, 1, 5)).toEqual([0, 0.2, 0.4, 0.6, 0.8, 1]);
    expect(linearTicks(-3, 12, 5)).toEqual([0, 5, 10]);
    expect(linearTicks(2, 2, 5)).toEqual([2]);
    expect(logTicks(0.2, 12)).toEqual([0.2, 0.5, 1, 2, 5, 10]);
    expect(logTicks(0.55, 1.3)).toEqual([0.6, 0.8, 1, 1.2]);
  });

  it('puts equal ratios at equal distances when it is logarithmic', () => {
    const log = makeScale(1, 100, 0, 200, true);
    expect(log.px(10)).toBeCloseTo(100);
    const linear = makeScale(0, 10, 50, 0, false);
    expect(linear.px(2)).toBeCloseTo(40);
  });
});

describe('the plot of a psychometric function', () => {
  const block: BlockResult = {
    name: 'friction',
    axis_label: 'friction coefficient',
    log_axis: true,
    reference: 0.835,
    levels: [
      { x: 0.6, k: 0, n: 3 },
      { x: 1.21, k: 3, n: 3 },
    ],
    curve: null,
    threshold: null,
    weber_fraction: null,
  };

  it('shows all levels and the reference with room beside them', () => {
    const { low, high } = boundsOf(block);
    expect(low).toBeLessThan(0.6);
    expect(low).toBeGreaterThan(0.5);
    expect(high).toBeGreaterThan(1.21);
    const alone = boundsOf({ ...block, levels: [] });
    expect(alone.low).toBeLessThan(0.835);
    expect(alone.high).toBeGreaterThan(0.835);
  });

  it('is linear after all when a level is not positive', () => {
    expect(isLog(block)).toBe(true);
    const with_zero = { ...block, levels: [{ x: 0, k: 0, n: 1 }] };
    expect(isLog(with_zero)).toBe(false);
    expect(boundsOf(with_zero).low).toBeLessThan(0);
  });

  it('reads the curve between its points only', () => {
    const curve: [number, number][] = [
      [1, 0],
      [2, 0.5],
      [4, 1],
    ];
    expect(shareAt(curve, 3)).toBeCloseTo(0.75);
    expect(shareAt(curve, 1)).toBe(0);
    expect(shareAt(curve, 5)).toBeNull();
  });

  it('has points whose area grows with the number of answers', () => {
    expect(pointRadius(8) / pointRadius(2)).toBeCloseTo(2);
    expect(pointRadius(10_000)).toBeLessThan(20);
  });
});
