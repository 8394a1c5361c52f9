// A participant who has not touched the soil cannot compare: an interval that is ended by a button requires a touch
// first.

import type { ParticipantMessage, Vec3 } from 'haptolith-protocol';

// Even a single particle that the tool moves causes a larger force.
const LEAST_FORCE_N = 0.02;

/** Whether the button of the screen waits for a touch. */
export function mustTouch({ phase, button }: Pick<ParticipantMessage, 'phase' | 'button'>): boolean {
  return phase === 'interval' && button !== null;
}

export class Touch {
  was_felt = false;

  /** Starts with a new screen. */
  begin(): void {
    this.was_felt = false;
  }

  /** Whether the soil has been touched, including the force of this frame. */
  felt(force_n: Vec3): boolean {
    this.was_felt ||= Math.hypot(...force_n) >= LEAST_FORCE_N;
    return this.was_felt;
  }
}
