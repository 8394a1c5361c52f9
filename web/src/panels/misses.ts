// Missed deadlines by their cause, in words.

import type { Status } from 'haptolith-protocol';

/** A sentence to follow EXPLAIN.in_time; '' before the first miss, and where an older program does not tell causes. */
export function missesInWords(status: Status): string {
  const { misses, misses_too_long, misses_woken_late, misses_preempted } = status;
  if (misses === 0 || misses_too_long === undefined) return '';
  return (
    `Since the start ${misses} missed it: ${misses_too_long} took too long, ` +
    `${misses_woken_late ?? 0} began late because the machine woke the loop late, ` +
    `and ${misses_preempted ?? 0} were interrupted by other programs.`
  );
}
