import type { Command, Frame, Scene } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import type { Connection } from '../../src/connection';
import { Hand } from '../../src/hand/hand';
import { clampTo, turned } from '../../src/hand/pose_math';
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
    hand.letGo('mouse');
    expect(hand.held).toBe(true);
    hand.letGo('keys');
    hand.letGo('keys');
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
    const bringer = new ToolBringer(hand, () => SCENE);
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

describe('sums with poses', () => {
  it('clamp to a box', () => {
    expect(clampTo(SCENE.workspace, [1, -1, 0.2])).toEqual([0.1, -0.1, 0.2]);
  });

  it('turn about an axis of the tool or of the scene', () => {
    const quarter = Math.PI / 2;
    const yawed = turned([1, 0, 0, 0], [0, 0, 1], quarter, 'scene');
    const about_tool = turned(yawed, [1, 0, 0], quarter, 'tool');
    const about_scene = turned(yawed, [0, 1, 0], quarter, 'scene');
    about_tool.forEach((value, i) => expect(value).toBeCloseTo(about_scene[i]!, 12));
  });
});
