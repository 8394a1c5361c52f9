import type { Status } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { missesInWords } from '../../src/panels/misses';

const status = (misses: Partial<Status>) => misses as Status;

describe('missed deadlines in words', () => {
  it('are told by their cause', () => {
    const words = missesInWords(status({ misses: 6, misses_too_long: 3, misses_woken_late: 2, misses_preempted: 1 }));
    expect(words).toContain('6 missed it: 3 took too long, 2 began late');
    expect(words).toContain('1 were interrupted');
  });

  it('are nothing before the first one, and from a program that does not tell causes', () => {
    expect(missesInWords(status({ misses: 0, misses_too_long: 0 }))).toBe('');
    expect(missesInWords(status({ misses: 4 }))).toBe('');
  });
});
