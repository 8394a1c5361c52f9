import type { Command, Frame, Pose, Quat, Scene, Tool } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import type { Connection } from '../../src/connection';
import { Hand } from '../../src/hand/hand';
import { angleBetween, clampTo, movedWith, turned } from '../../src/hand/pose_math';
import { noseDown, tiltOf, ToolTilt } from '../../src/hand/tilt';
import { ToolBringer } from '../../src/hand/tool_bringer';

const SCENE = {
  workspace: { low_m: [-0.1, -0.1, 0], high_m: [0.1, 0.1, 0.3] },
  box: { surface_m: 0.04 },
  tool: { shape: 'box', size_mm: [50, 40, 5], diameter_mm: 60 },
} as unknown as Scene;
const FRAME = { tool: { position_m: [0, 0, 0.1], rotation: [1, 0, 0, 0] } } as unknown as Frame;

function makeHand(accept = true) {
  const sent: Command[] = [];
  const refused: Error[] = [];
  const connection = {
    connected: true,
    send: (command: Command) => sent.push(command),
    request: (command: Command) => {
      sent.push(command);
      return accept ? Promise.resolve() : Promise.reject(new Error('client 2 holds the tool'));
    },
  } as unknown as Connection;
  const hand = new Hand(
    connection,
    (error) => refused.push(error),
    () => {},
  );
  hand.setScene(SCENE);
  hand.setFrame(FRAME);
  return { hand, sent, refused };
}

describe('the hand', () => {
  it('takes the tool where it is', () => {
    const { hand, sent } = makeHand();
    expect(hand.grab('mouse')).toBe(true);
    expect(sent).toEqual([{ do: 'hold', pose: [0, 0, 0.1, 1, 0, 0, 0] }]);
  });

  it('names its tool where there are several, and releases it before it takes another', () => {
    const { hand, sent } = makeHand();
    hand.choose('left');
    expect(sent).toEqual([]);
    hand.grab('mouse');
    hand.choose('left');
    hand.choose('right');
    expect(hand.held).toBe(false);
    hand.grab('keys');
    hand.release('keys');
    expect(sent.map((command) => [command.do, 'tool' in command && command.tool])).toEqual([
      ['hold', 'left'],
      ['release', 'left'],
      ['hold', 'right'],
      ['release', 'right'],
    ]);
  });

  it('never wishes the tool out of the workspace', () => {
    const { hand, sent } = makeHand();
    hand.grab('mouse');
    hand.move([5, -5, -5]);
    hand.tick(1000);
    expect(sent.at(-1)).toEqual({ do: 'hold', pose: [0.1, -0.1, 0, 1, 0, 0, 0] });
  });

  it('sends at most 60 wishes a second, and only new ones', () => {
    const { hand, sent } = makeHand();
    hand.grab('mouse');
    for (let ms = 100; ms < 1100; ms += 4) {
      hand.move([0.00001, 0, 0]);
      hand.tick(ms);
    }
    expect(sent.length).toBeGreaterThan(40);
    expect(sent.length).toBeLessThanOrEqual(64);
    const before = sent.length;
    for (let ms = 2000; ms < 3000; ms += 4) hand.tick(ms);
    expect(sent.length).toBeLessThanOrEqual(before + 1);
  });

  it('lets go when the last holder has', () => {
    const { hand, sent } = makeHand();
    hand.grab('mouse');
    hand.grab('keys');
    hand.release('mouse');
    expect(hand.held).toBe(true);
    hand.release('keys');
    hand.release('keys');
    expect(sent.filter((command) => command.do === 'release')).toHaveLength(1);
  });

  it('drops the tool when somebody else has it', async () => {
    const { hand, sent, refused } = makeHand(false);
    hand.grab('mouse');
    await Promise.resolve();
    await Promise.resolve();
    expect(hand.held).toBe(false);
    expect(refused).toHaveLength(1);
    expect(sent.some((command) => command.do === 'release')).toBe(false);
  });
});

describe('bringing the tool', () => {
  const BURIED = { tool: { position_m: [0.08, -0.05, 0.01], rotation: [1, 0, 0, 0] } } as unknown as Frame;

  function bring(ticks: number, during?: (hand: Hand) => void) {
    const { hand, sent } = makeHand();
    hand.setFrame(BURIED);
    const bringer = new ToolBringer(
      hand,
      () => SCENE,
      () => noseDown([1, 0, 0], 55),
    );
    bringer.start();
    for (let i = 0; i < ticks; ++i) {
      bringer.tick(1000 + 16 * i);
      hand.tick(1000 + 16 * i);
      if (i === 5) during?.(hand);
    }
    const path_m = sent.flatMap((command) => (command.do === 'hold' ? [command.pose] : []));
    return { hand, sent, path_m };
  }

  it('lifts it out of the soil before it moves it across, to the middle of the bed, and lets go there', () => {
    const { hand, sent, path_m } = bring(300);
    const across = path_m.findIndex(([x]) => x !== 0.08);
    expect(path_m[across - 1]![2]).toBeCloseTo(0.085, 6);
    const [x, y, z] = path_m.at(-1)!;
    expect([x, y, z].map((value) => Number(value.toFixed(6)))).toEqual([0, 0, 0.085]);
    expect(hand.held).toBe(false);
    expect(sent.at(-1)).toEqual({ do: 'release' });
  });

  it('turns its nose down, so that it digs', () => {
    const { path_m } = bring(300);
    const [, , , ...rotation] = path_m.at(-1)!;
    expect(tiltOf(rotation)).toBeCloseTo(55, 3);
  });

  it('moves no faster than a calm hand', () => {
    const { path_m } = bring(300);
    for (let i = 1; i < path_m.length; ++i) {
      const [a, b] = [path_m[i - 1]!, path_m[i]!];
      expect(Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2])).toBeLessThan(0.15 * 0.04);
    }
  });

  it('stops when a person takes the tool', () => {
    const { hand, path_m } = bring(300, (held) => held.grab('mouse'));
    expect(hand.isHeldBy('automation')).toBe(false);
    expect(hand.isHeldBy('mouse')).toBe(true);
    expect(path_m.at(-1)![2]).toBeLessThan(0.05);
  });
});

describe('the tilt of the tool', () => {
  const BOX = SCENE.tool;
  const NOSE_45: Quat = noseDown([1, 0, 0], 45);

  function makeTilt(tool: Partial<Tool> = {}, rotation: Quat = [1, 0, 0, 0]) {
    const { hand, sent } = makeHand();
    const frame = { tool: { position_m: [0, 0, 0.1], rotation } } as unknown as Frame;
    hand.setFrame(frame);
    const scene = { ...SCENE, tool: { ...BOX, ...tool } } as Scene;
    const tilt = new ToolTilt(
      hand,
      () => scene,
      () => frame,
      () => [0, 1, 0],
    );
    let now_ms = 1000;
    const run = (seconds: number): void => {
      for (const end_ms = now_ms + 1000 * seconds; now_ms < end_ms; now_ms += 16) {
        tilt.tick(now_ms);
        hand.tick(now_ms);
      }
    };
    const grab = (): void => {
      hand.grab('mouse');
      tilt.taken();
    };
    return { hand, sent, tilt, run, grab };
  }

  it('is told from its rotation, whichever way its nose points', () => {
    for (const tilt_deg of [-30, 0, 55, 90, 120])
      expect(tiltOf(noseDown([0.6, 0.8, 0], tilt_deg))).toBeCloseTo(tilt_deg, 9);
  });

  it('of a shovel that a pointer takes goes to one that digs, across the picture and calmly', () => {
    const { hand, run, grab } = makeTilt();
    grab();
    run(0.2);
    expect(tiltOf(hand.wished.rotation)).toBeLessThan(35);
    run(2);
    expect(angleBetween(hand.wished.rotation, noseDown([0, 1, 0], 55))).toBeLessThan(0.01);
  });

  it('goes there after a click, too', () => {
    const { hand, run, grab } = makeTilt();
    grab();
    run(0.1);
    hand.release('mouse');
    run(3);
    expect(tiltOf(hand.wished.rotation)).toBeCloseTo(55, 1);
    expect(hand.held).toBe(false);
  });

  it.each(['sphere', 'plate', 'cylinder', 'jaws', 'mesh'] as const)('of a %s stays as it is', (shape) => {
    const { hand, run, grab } = makeTilt({ shape });
    grab();
    run(1);
    expect(hand.wished.rotation).toEqual([1, 0, 0, 0]);
  });

  it('stays as a person has left it', () => {
    const { hand, run, grab } = makeTilt({}, NOSE_45);
    hand.grab('keys');
    hand.release('keys');
    grab();
    run(1);
    expect(hand.wished.rotation).toEqual(NOSE_45);
  });

  it('yields to keys that turn the tool', () => {
    const { hand, run, grab } = makeTilt();
    grab();
    run(0.1);
    hand.turn([0, 1, 0], -0.05, 'tool');
    const then = hand.wished.rotation;
    run(1);
    expect(hand.wished.rotation).toEqual(then);
  });

  it('is set by a slider, which takes the tool and lets go of it', () => {
    const { hand, sent, tilt, run } = makeTilt();
    expect(tilt.set(30)).toBe(true);
    expect(tilt.now_deg).toBeCloseTo(30, 9);
    run(2);
    expect(hand.held).toBe(false);
    const poses = sent.flatMap((command) => (command.do === 'hold' ? [command.pose] : []));
    const [, , , ...rotation] = poses.at(-1)!;
    expect(tiltOf(rotation)).toBeCloseTo(30, 3);
  });
});

describe('sums with poses', () => {
  it('clamp to a box', () => {
    expect(clampTo(SCENE.workspace, [1, -1, 0.2])).toEqual([0.1, -0.1, 0.2]);
  });

  it('move a turned tool with its hub', () => {
    const half = Math.SQRT1_2;
    const hub: Pose = { position_m: [1, 0, 0], rotation: [1, 0, 0, 0] };
    const tool: Pose = { position_m: [1.5, 0, 0], rotation: [half, half, 0, 0] };
    const to: Pose = { position_m: [0, 2, 0], rotation: [half, 0, 0, half] };
    const { position_m, rotation } = movedWith(tool, hub, to);
    position_m.forEach((value, axis) => expect(value).toBeCloseTo([0, 2.5, 0][axis]!, 12));
    rotation.forEach((value) => expect(value).toBeCloseTo(0.5, 12));
  });

  it('turn about an axis of the tool or of the scene', () => {
    const quarter = Math.PI / 2;
    const yawed = turned([1, 0, 0, 0], [0, 0, 1], quarter, 'scene');
    const about_tool = turned(yawed, [1, 0, 0], quarter, 'tool');
    const about_scene = turned(yawed, [0, 1, 0], quarter, 'scene');
    about_tool.forEach((value, i) => expect(value).toBeCloseTo(about_scene[i]!, 12));
  });
});

describe('the angle between rotations', () => {
  it('is nothing between a rotation and itself, also as rounded to single precision', () => {
    for (const q of [
      [0.9659, 0, 0.2588, 0],
      [0.9876607060432434, 0, 0.1565081775188446, 0],
    ] as Quat[]) {
      expect(angleBetween(q, q)).toBeLessThan(1e-7);
    }
  });
});
