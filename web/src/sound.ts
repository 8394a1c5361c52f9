// The sound of digging, off by default: noise whose loudness depends on the tool's work on the soil. Its pitch is the
// rate at which real grains of 0.1 mm diameter pass the tool. On the Moon it would be transmitted by the handle,
// because there is no air.

import type { Frame, FrameHeader, Pose, Quat, Vec3 } from 'haptolith-protocol';

// Loudness grows with power, so amplitude with its square root; it saturates at this power.
const LOUDEST_W = 0.5;
const LOUDEST = 0.5;
// Half of the Moon's soil, by mass, is finer than 0.04 to 0.13 mm: Carrier, Olhoeft and Mendell, Lunar Sourcebook (1991), 9.1.
const GRAIN_M = 1e-4;
const PITCH_HZ = { low: 180, high: 5000 } as const;
// A knock: the force rises by more than `least` from one frame to the next; it is loudest at `loudest`.
const KNOCK_N = { least: 0.5, loudest: 5 } as const;
const LONGEST_GAP_S = 0.25;
const NOISE_S = 2;
// Percentage of noise samples that are not zero: soil crackles, and does not hiss.
const CRACKLE = 12;

/** Motion between two frames as input of the sound. */
export interface Sounding {
  /** work on the soil, W */
  power_w: number;
  /** speed of the tool's origin, m/s */
  speed_m_s: number;
  /** increase of the force, N */
  rise_n: number;
}

/** Returns the motion from one frame to the next; null: unknown. */
export function sounding(before: FrameHeader | null, now: FrameHeader): Sounding | null {
  const elapsed_s = before ? now.time_s - before.time_s : 0;
  if (!before || before.scene !== now.scene || elapsed_s <= 0 || elapsed_s > LONGEST_GAP_S) return null;
  const way_m = now.tool.position_m.map((value, axis) => value - before.tool.position_m[axis]!) as Vec3;
  const turned_rad = turnBetween(before.tool, now.tool);
  // The force is the soil's on the hand, so the hand's work against it is work on the soil.
  const work_j = -(
    dot(mean(before.force_n, now.force_n), way_m) + dot(mean(before.torque_nm, now.torque_nm), turned_rad)
  );
  return {
    power_w: Math.max(0, work_j / elapsed_s),
    speed_m_s: Math.hypot(...way_m) / elapsed_s,
    rise_n: Math.hypot(...now.force_n) - Math.hypot(...before.force_n),
  };
}

/** Returns the amplitude, 0 to 1. */
export function loudness(power_w: number): number {
  return LOUDEST * Math.min(1, Math.sqrt(power_w / LOUDEST_W));
}

export function pitch_hz(speed_m_s: number): number {
  return Math.min(PITCH_HZ.high, Math.max(PITCH_HZ.low, speed_m_s / GRAIN_M));
}

/** Returns the amplitude, 0 to 1, of a tool that knocks against a stone. */
export function knock(rise_n: number): number {
  return rise_n < KNOCK_N.least ? 0 : LOUDEST * Math.min(1, rise_n / KNOCK_N.loudest);
}

export class SoilSound {
  private context: AudioContext | null = null;
  private grains: { gain: GainNode; filter: BiquadFilterNode } | null = null;
  private stones: { gain: GainNode; filter: BiquadFilterNode } | null = null;
  private last: FrameHeader | null = null;

  /** `make`: creates the audio output; null where the browser has none. */
  constructor(
    private readonly make: () => AudioContext | null = () => (self.AudioContext ? new AudioContext() : null),
  ) {}

  /** Turns the sound on or off. To be called from a click: browsers are silent until then. False: this browser
   * cannot play sound. */
  setOn(on: boolean): boolean {
    if (!on) {
      void this.context?.close();
      this.context = this.grains = this.stones = this.last = null;
      return true;
    }
    this.context ??= this.make();
    if (!this.context) return false;
    void this.context.resume();
    this.grains ??= this.voice('bandpass', PITCH_HZ.low);
    this.stones ??= this.voice('lowpass', 260);
    return true;
  }

  setFrame(frame: Frame): void {
    const { context, grains, stones } = this;
    if (!context || !grains || !stones) return;
    const heard = sounding(this.last, frame);
    this.last = frame;
    if (!heard) return;
    const now_s = context.currentTime;
    grains.filter.frequency.setTargetAtTime(pitch_hz(heard.speed_m_s), now_s, 0.03);
    // Fades out soon unless another frame comes.
    swell(grains.gain.gain, loudness(heard.power_w), now_s, 0.02, 0.1);
    const hit = frame.stones.length > 0 ? knock(heard.rise_n) : 0;
    if (hit > 0) swell(stones.gain.gain, hit, now_s, 0.002, 0.01);
  }

  private voice(type: BiquadFilterType, frequency_hz: number): { gain: GainNode; filter: BiquadFilterNode } {
    const context = this.context!;
    const source = context.createBufferSource();
    source.buffer = context.createBuffer(1, NOISE_S * context.sampleRate, context.sampleRate);
    source.buffer.getChannelData(0).set(crackle(NOISE_S * context.sampleRate));
    source.loop = true;
    const filter = context.createBiquadFilter();
    filter.type = type;
    filter.frequency.value = frequency_hz;
    const gain = context.createGain();
    gain.gain.value = 0;
    source.connect(filter).connect(gain).connect(context.destination);
    source.start();
    return { gain, filter };
  }
}

/** Returns noise of single grains, which is mostly silence. */
export function crackle(samples: number): Float32Array {
  const noise = new Float32Array(samples);
  for (let i = 0; i < samples; ++i) if (100 * Math.random() < CRACKLE) noise[i] = 2 * Math.random() - 1;
  return noise;
}

function swell(gain: AudioParam, to: number, now_s: number, rise_s: number, held_s: number): void {
  gain.cancelScheduledValues(now_s);
  gain.setTargetAtTime(to, now_s, rise_s);
  gain.setTargetAtTime(0, now_s + held_s, 0.05);
}

/** Returns the small rotation from one pose to another, rad, scene frame. */
function turnBetween(before: Pose, now: Pose): Vec3 {
  const [w, x, y, z] = before.rotation;
  const [real, ...axis] = times(now.rotation, [w, -x, -y, -z]);
  return axis.map((value) => 2 * value * Math.sign(real || 1)) as Vec3;
}

function times([aw, ax, ay, az]: Quat, [bw, bx, by, bz]: Quat): Quat {
  return [
    aw * bw - ax * bx - ay * by - az * bz,
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
  ];
}

const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const mean = (a: Vec3, b: Vec3): Vec3 => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2];
