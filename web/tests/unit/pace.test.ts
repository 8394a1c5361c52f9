import type { Status } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { missesInWords, paceInBrief, paceInWords, PaceWatch, type Pace } from '../../src/panels/pace';

type Part = Partial<Status>;

/** Simulates a loop for some seconds, with a status four times a second; `missed` returns the misses up to a tick. */
function watch(seconds: number, missed: (ticks: number) => Part, rest: Part = {}): Pace {
  const paces = new PaceWatch();
  let pace: Pace | null = null;
  for (let ms = 0; ms <= 1000 * seconds; ms += 250) {
    const ticks = 50_000 + ms;
    const status = { ticks, misses: 0, rate_hz: 1000, speed: 1, paused: false, ...missed(ms), ...rest };
    pace = paces.add(status as Status, 7000 + ms);
  }
  return pace!;
}

const few = (ms: number): Part => ({ misses: Math.floor(ms / 500) }); // 0.2 %
const many = (ms: number): Part => ({ misses: ms / 10 });

describe('the pace of the loop', () => {
  it('is in time after ten seconds, and not after the last hundred ticks', () => {
    expect(watch(5, few).kind).toBe('measuring');
    expect(watch(11, few).kind).toBe('in time');
  });

  it('is late after two seconds', () => {
    expect(watch(1, many).kind).toBe('measuring');
    expect(watch(3, many).kind).toBe('late');
  });

  it('is late when the loop does not come to its ticks, however few it misses', () => {
    expect(watch(11, () => ({ misses: 0, rate_hz: 900 })).kind).toBe('late');
  });

  it('forgets what is older than ten seconds', () => {
    const pace = watch(30, (ms) => ({ misses: Math.min(ms, 10_000) }));
    expect(pace).toMatchObject({ kind: 'in time', misses: 0 });
    expect(pace.ticks).toBe(10_000);
  });

  it('says which ticks were late for which reason, where the program says so', () => {
    const causes = (ms: number): Part => ({
      misses: ms / 10,
      misses_too_long: ms / 100,
      misses_woken_late: ms / 20,
      misses_preempted: ms / 25,
    });
    const pace = watch(10, causes);
    expect(missesInWords(pace)).toBe('1000 of 10000: 100 too long, 500 woken late, 400 preempted');
    expect(pace.others).toBe(true);
    expect(missesInWords(watch(10, many))).toBe('1000 of 10000');
  });

  it('blames the soil or other programs, and offers coarser soil where there is some', () => {
    const soil = watch(11, many);
    expect(paceInBrief(soil, true)).toBe('late: coarser soil?');
    expect(paceInBrief(soil, false)).toBe('late');
    expect(paceInWords(soil, true)).toContain('too small for this machine');
    const others = { ...soil, others: true };
    expect(paceInBrief(others, true)).toBe('late: other programs');
    expect(paceInWords(others, true)).toMatch(/Other programs delay the force loop.*Coarser particles/);
    expect(paceInWords(others, false)).not.toContain('Coarser');
  });

  it('is nothing to judge in a pause or in slow motion', () => {
    expect(watch(11, many, { paused: true }).kind).toBe('paused');
    expect(watch(11, many, { speed: 0.1, rate_hz: 100 }).kind).toBe('slow motion');
  });
});
