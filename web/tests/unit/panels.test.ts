import type { Frame, Robot, Scene } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { EXPLAIN, frictionModelName, sliderExplanation } from '../../src/panels/explanations';
import { inWords } from '../../src/panels/plots';
import { pictureInWords, placeOf, robotInWords, sizesInWords } from '../../src/panels/readouts';

describe('the place of the tool', () => {
  it('is a height above the soil or a depth in it, never a negative one', () => {
    expect(placeOf(0.1, 0.04)).toEqual({ name: 'above soil', mm: expect.closeTo(60, 9) });
    expect(placeOf(0.03, 0.04)).toEqual({ name: 'depth', mm: expect.closeTo(10, 9) });
    expect(placeOf(0.04, 0.04).mm).toBe(0);
  });
});

describe('in words', () => {
  it('the picture says where the tool is and what it feels', () => {
    const scene = {
      box: { width_m: 0.126, length_m: 0.126, surface_m: 0.04 },
      particles: 256,
      radius_m: 0.007,
      tool: { shape: 'box' },
    };
    const frame = { tool: { position_m: [0.01, -0.02, 0.03] }, force_n: [0, 3, 4] };
    expect(pictureInWords(scene as unknown as Scene, frame as unknown as Frame)).toBe(
      'A box of 126 by 126 mm with 256 particles; shovel 10 mm deep in the soil, at x 10 mm, y -20 mm; force 5.00 N.',
    );
  });

  it('grains are counted by their size, coarsest first', () => {
    const grains = [{ count: 16, radius_m: 0.007 }, { count: 3, radius_m: 0.00175 }, { count: 32, radius_m: 0.0035 }]; // prettier-ignore
    const scene = { particles: 51, radius_m: 0.007, grains } as unknown as Scene;
    expect(sizesInWords(scene)).toBe('16 of 7 mm, 32 of 3.5 mm, 3 of 1.75 mm');
    const box = { width_m: 0.126, length_m: 0.126, surface_m: 0.04 };
    const frame = { tool: { position_m: [0, 0, 0.05] }, force_n: [0, 0, 0] } as unknown as Frame;
    expect(pictureInWords({ ...scene, box, tool: { shape: 'box' } } as unknown as Scene, frame)).toContain(
      'with 51 particles (16 of 7 mm, 32 of 3.5 mm, 3 of 1.75 mm radius); shovel 10 mm above the soil',
    );
  });

  it('a robot says what it does, why it stopped, and how old that is', () => {
    const robot = { state: 'following', reason: null, heard: true, behind: 2649, round_trip_s: 2.6 } as Robot;
    expect(robotInWords(robot)).toBe('robot following, 2.6 s behind');
    expect(robotInWords({ ...robot, state: 'holding', reason: 'too much force' })).toBe(
      'robot holding (too much force), 2.6 s behind',
    );
    expect(robotInWords({ ...robot, behind: 9000 })).toBe('robot following, 9.0 s behind, link delay 2.6 s');
    expect(robotInWords({ ...robot, heard: false })).toBe('robot silent');
    expect(robotInWords({ ...robot, heard: false, round_trip_s: 0 })).toBe('no reports from the robot yet');
  });

  it('a plot says what each line is now and where it has been', () => {
    const lines = ['x', 'late'].map((name) => ({ name, colour: '', width: 1, points: name === 'late' }));
    const table: [number[], (number | null)[], (number | null)[]] = [
      [-1, -0.5, 0],
      [3, null, -1],
      [null, null, 9],
    ];
    expect(inWords({ title: 'Force', unit: 'N', lines }, table)).toBe(
      'Force in N over the last ten seconds. x -1, from -1 to 3; late 1 time.',
    );
    expect(inWords({ title: 'Force', unit: 'N', lines }, [[], [], []])).toContain('No data yet');
  });
});

describe('an explanation', () => {
  it.each(Object.entries(EXPLAIN))('is one plain sentence: %s', (_name, text) => {
    expect(text).toMatch(/^[A-Z\dx].*\.$/);
    expect(text.length).toBeLessThan(240);
  });
});

describe('a slider', () => {
  it('says where its number is an estimate, and what a number of a contact is', () => {
    expect(sliderExplanation('friction_angle_deg', 'icra2021')).not.toContain('estimate');
    expect(sliderExplanation('friction_angle_deg', 'contact')).toContain('estimate');
    expect(sliderExplanation('cohesion_pa', 'contact')).toContain('estimate');
    expect(sliderExplanation('contact_friction', 'contact')).toContain('between two particles');
    expect(sliderExplanation('another', 'icra2021')).toBeNull();
  });
});

describe('a model of friction', () => {
  it('has a name that is not "friction"', () => {
    expect(frictionModelName('icra2021')).toBe('ICRA 2021 (drag against space)');
    expect(frictionModelName('contact')).toBe('contact');
    expect(frictionModelName('another')).toBe('another');
  });
});
