// Who has not touched the soil has nothing to compare: an interval that a person ends by a button ends only after that.

import type { ParticipantMessage, Vec3 } from 'haptolith-protocol';

// A single grain that the tool moves is felt as more.
const LEAST_FORCE_N = 0.02;

/** Whether the button of what is shown waits for a touch. */
export function mustTouch({ phase, button }: Pick<ParticipantMessage, 'phase' | 'button'>): boolean {
  return phase === 'interval' && button !== null;
}

export class Touch {
  was_felt = false;

  /** Something else is shown. */
  begin(): void {
    this.was_felt = false;
  }

  /** Whether the soil has been touched, with the force of this frame. */
  felt(force_n: Vec3): boolean {
    this.was_felt ||= Math.hypot(...force_n) >= LEAST_FORCE_N;
    return this.was_felt;
  }
}
