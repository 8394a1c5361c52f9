import { describe, expect, it } from 'vitest';
import type { Connection } from '../../src/connection';
import { Hand } from '../../src/hand/hand';
import { clampTo, turned } from '../../src/hand/pose_math';
import type { Command, Frame, Scene } from '../../src/protocol';

const SCENE = { workspace: { low_m: [-0.1, -0.1, 0], high_m: [0.1, 0.1, 0.3] } } as unknown as Scene;
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
