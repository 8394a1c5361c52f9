import type { Frame, NamedTool, Scene, ToolState } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { frameOf, nameOf, sceneOf } from '../../src/own_tool';

const [LEFT, RIGHT] = ['left', 'right'].map((name) => ({ name, motion: `${name} motion` }) as NamedTool);
const BAND = { low_n: 1, high_n: 2 };
const HAND = { motion: 'still', max_force_n: 12, max_torque_nm: 0.2 };
const ONE = { tool: { shape: 'box' }, hand: HAND } as Scene;
const TWO = { ...ONE, tools: [LEFT, RIGHT] } as Scene;

describe('the tool of a page', () => {
  it('is the only one, without a name, in a scene with one', () => {
    expect(sceneOf(ONE, 0)).toBe(ONE);
    expect(nameOf(ONE, 0)).toBeUndefined();
    expect(nameOf({ ...ONE, tools: [LEFT!] }, 0)).toBeUndefined();
    const frame = { held: true, tools: [] as ToolState[] } as Frame;
    expect(frameOf(frame, 0)).toBe(frame);
  });

  it('is the chosen one of several', () => {
    expect(sceneOf(TWO, 1)).toMatchObject({ tool: RIGHT, hand: { motion: 'right motion', max_force_n: 12 } });
    expect([nameOf(TWO, 0), nameOf(TWO, 1)]).toEqual(['left', 'right']);
    const state = { hub: 'hub', turned: 'turned', force_n: [1, 2, 3], held_by: 7 } as unknown as ToolState;
    const frame = { held: false, number: 5, tools: [{ held_by: 0 }, state], bands: [null, BAND] } as Frame;
    expect(frameOf(frame, 1)).toMatchObject({ tool: 'hub', force_n: [1, 2, 3], held: true, number: 5, bands: [BAND] });
    expect(frameOf(frame, 0).held).toBe(false);
  });
});
