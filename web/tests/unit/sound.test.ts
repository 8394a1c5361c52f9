import type { Frame, Quat, Vec3 } from 'haptolith-protocol';
import { describe, expect, it, vi } from 'vitest';
import { crackle, knock, loudness, pitch_hz, SoilSound, sounding } from '../../src/sound';

function frame(over: Partial<Frame> & { at_m?: Vec3; rotation?: Quat }): Frame {
  const { at_m = [0, 0, 0], rotation = [1, 0, 0, 0], ...rest } = over;
  return {
    scene: 1,
    time_s: 0,
    force_n: [0, 0, 0],
    torque_nm: [0, 0, 0],
    tool: { position_m: at_m, rotation },
    stones: new Float32Array(),
    ...rest,
  } as Frame;
}

describe('what a movement sounds like', () => {
  const before = frame({ force_n: [-2, 0, 0] });

  it('is the work of the hand against the force', () => {
    const heard = sounding(before, frame({ time_s: 0.02, at_m: [0.002, 0, 0], force_n: [-2, 0, 0] }))!;
    expect(heard.power_w).toBeCloseTo(2 * 0.1, 9);
    expect(heard.speed_m_s).toBeCloseTo(0.1, 9);
  });

  it('is nothing when the soil pushes the tool', () => {
    expect(sounding(before, frame({ time_s: 0.02, at_m: [-0.002, 0, 0], force_n: [-2, 0, 0] }))!.power_w).toBe(0);
  });

  it('counts turning, either way round the quaternion', () => {
    const half_rad = 0.005;
    for (const sign of [1, -1]) {
      const rotation: Quat = [sign * Math.cos(half_rad), 0, 0, sign * Math.sin(half_rad)];
      const heard = sounding(
        frame({ torque_nm: [0, 0, -0.1] }),
        frame({ time_s: 0.02, torque_nm: [0, 0, -0.1], rotation }),
      )!;
      expect(heard.power_w).toBeCloseTo((0.1 * 2 * half_rad) / 0.02, 6);
    }
  });

  it('is not known across another bed, a pause or a step back in time', () => {
    expect(sounding(null, before)).toBeNull();
    expect(sounding(before, frame({ time_s: 0.02, scene: 2 }))).toBeNull();
    expect(sounding(before, frame({ time_s: 1 }))).toBeNull();
    expect(sounding(frame({ time_s: 1 }), before)).toBeNull();
    expect(sounding(before, before)).toBeNull();
  });
});

describe('loudness and pitch', () => {
  it('grow with power and speed, within bounds', () => {
    expect(loudness(0)).toBe(0);
    expect(loudness(0.2) / loudness(0.05)).toBeCloseTo(2, 9);
    expect(loudness(1e6)).toBeLessThanOrEqual(1);
    expect(pitch_hz(0.1)).toBeCloseTo(1000, 6);
    expect(pitch_hz(0)).toBeGreaterThan(100);
    expect(pitch_hz(1e3)).toBeLessThan(20_000);
  });

  it('make knocks of sudden rises only', () => {
    expect(knock(0.1)).toBe(0);
    expect(knock(-3)).toBe(0);
    expect(knock(3)).toBeGreaterThan(knock(1));
    expect(knock(1e3)).toBeLessThanOrEqual(1);
  });

  it('are of a noise that is mostly silence', () => {
    const noise = crackle(20_000);
    const heard = noise.filter((value) => value !== 0).length / noise.length;
    expect(heard).toBeGreaterThan(0.1);
    expect(heard).toBeLessThan(0.14);
    expect(Math.max(...noise.map(Math.abs))).toBeLessThanOrEqual(1);
  });
});

describe('SoilSound', () => {
  const param = () => ({ value: 0, setTargetAtTime: vi.fn(), cancelScheduledValues: vi.fn() });
  function fakeContext() {
    const gains: { gain: ReturnType<typeof param> }[] = [];
    const node = <T extends object>(more: T) => ({ connect: (to: unknown) => to, ...more });
    const context = {
      currentTime: 3,
      sampleRate: 1000,
      destination: node({}),
      resume: vi.fn(),
      close: vi.fn(),
      createBuffer: (_channels: number, length: number) => ({ getChannelData: () => new Float32Array(length) }),
      createBufferSource: () => node({ start: vi.fn() }),
      createBiquadFilter: () => node({ frequency: param() }),
      createGain: () => {
        const gain = node({ gain: param() });
        gains.push(gain);
        return gain;
      },
    };
    return { context: context as unknown as AudioContext, gains };
  }

  const dug = frame({ time_s: 0.02, at_m: [0.002, 0, 0], force_n: [-2, 0, 0] });

  it('is silent until it is wanted, and falls silent by itself', () => {
    const { context, gains } = fakeContext();
    const sound = new SoilSound(() => context);
    sound.setFrame(frame({ force_n: [-2, 0, 0] }));
    expect(gains).toHaveLength(0);
    expect(sound.setOn(true)).toBe(true);
    sound.setFrame(frame({ force_n: [-2, 0, 0] }));
    sound.setFrame(dug);
    const [grains, stones] = gains;
    expect(grains!.gain.setTargetAtTime.mock.calls[0]![0]).toBeCloseTo(loudness(0.2), 6);
    expect(grains!.gain.setTargetAtTime.mock.calls.at(-1)![0]).toBe(0);
    expect(stones!.gain.setTargetAtTime).not.toHaveBeenCalled();
    sound.setOn(false);
    expect(context.close).toHaveBeenCalled();
    sound.setFrame(dug);
  });

  it('knocks where there are stones', () => {
    const { context, gains } = fakeContext();
    const sound = new SoilSound(() => context);
    sound.setOn(true);
    const stones = new Float32Array(7);
    sound.setFrame(frame({ stones }));
    sound.setFrame({ ...dug, stones });
    expect(gains[1]!.gain.setTargetAtTime.mock.calls[0]![0]).toBeCloseTo(knock(2), 6);
  });

  it('says when the browser plays nothing', () => {
    expect(new SoilSound(() => null).setOn(true)).toBe(false);
  });
});
