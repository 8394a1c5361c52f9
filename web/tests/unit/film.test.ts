import { decodeFrame } from 'haptolith-protocol';
import { describe, expect, it } from 'vitest';
import { addressOf, readShown } from '../../src/demo/address';
import { FilmPictures, readFilm } from '../../src/demo/film';
import { encodeFrame, type RecordValues } from '../frame-bytes';

const POSE = { position_m: [0, 0, 0.1], rotation: [1, 0, 0, 0] } as const;
const record = (x: number): RecordValues => ({ x, y: 2, z: 3, speed: 4, force: 5 });

function picture(time_s: number, runs: [number, number][], records: RecordValues[], stones = 0): ArrayBuffer {
  const header = {
    scene: 1,
    time_s,
    paused: false,
    held: false,
    whole: records.length === 4,
    forcesValid: true,
    tool: structuredClone(POSE) as never,
    force_n: [0, 0, 1] as [number, number, number],
    torque_nm: [0, 0, 0] as [number, number, number],
    wished: structuredClone(POSE) as never,
    longestTick_us: 0,
    misses: 0,
    awake: 4,
    particles: 4,
    number: 1 + time_s,
    opening_m: 0,
  };
  return encodeFrame(header, runs, records, Array<never>(stones).fill(structuredClone(POSE) as never));
}

function filmOf(frames: ArrayBuffer[]): ArrayBuffer {
  const parts: Uint8Array[] = [new TextEncoder().encode('haptolith film 1')];
  const add = (kind: number, bytes: Uint8Array): void => {
    const head = new Uint8Array(5);
    new DataView(head.buffer).setUint32(0, bytes.length, true);
    head[4] = kind;
    parts.push(head, bytes);
  };
  add(1, new TextEncoder().encode('{"type":"hello"}'));
  for (const frame of frames) add(2, new Uint8Array(frame));
  const whole = new Uint8Array(parts.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole.buffer;
}

const FRAMES = [
  picture(0, [[0, 4]], [1, 2, 3, 4].map(record), 1),
  picture(1, [[1, 2]], [20, 30].map(record), 1),
  picture(2, [[3, 1]], [record(40)], 1),
];
const xs = (bytes: ArrayBuffer): number[] => {
  const { records, whole, runs } = decodeFrame(bytes);
  expect(whole).toBe(true);
  expect([...runs]).toEqual([0, 4]);
  return [0, 1, 2, 3].map((i) => records[4 * i]!);
};

describe('a film', () => {
  it('has every picture whole, in any order', () => {
    const film = readFilm(filmOf(FRAMES));
    expect(film.texts).toEqual(['{"type":"hello"}']);
    expect(film.frames.map(({ time_s }) => time_s)).toEqual([0, 1, 2]);
    const pictures = new FilmPictures(film);
    expect(xs(pictures.whole(2))).toEqual([1, 20, 30, 40]);
    expect(xs(pictures.whole(0))).toEqual([1, 2, 3, 4]);
    expect(xs(pictures.whole(1))).toEqual([1, 20, 30, 4]);
    expect(xs(pictures.whole(1))).toEqual([1, 20, 30, 4]);
    expect(decodeFrame(pictures.whole(2)).stones).toEqual(decodeFrame(FRAMES[2]!).stones);
    expect(decodeFrame(pictures.whole(1)).time_s).toBe(1);
  });

  it('that was cut off has what comes before', () => {
    const bytes = filmOf(FRAMES);
    expect(readFilm(bytes.slice(0, bytes.byteLength - 3)).frames.length).toBe(2);
  });

  it('that is none is told', () => {
    expect(() => readFilm(new TextEncoder().encode('a page that was not found').buffer as ArrayBuffer)).toThrow(
      /not an animation/,
    );
    expect(() => readFilm(filmOf([]))).toThrow(/no frames/);
  });
});

describe("the demo's address", () => {
  it('says the same to who reads it', () => {
    const shown = {
      scene: 'icra2021',
      changes: 'gravity.vector_m_s2=[0, 0, -3.72]\nnames.body="Mars & Co"\n',
      eye: { azimuth_deg: 31.4, elevation_deg: 20, zoom: 1.5, aside_m: [0.01, -0.02] as [number, number] },
    };
    const address = addressOf('https://host/demo/?theme=dark#x', shown, { colour: 'force', drawing: 'balls' });
    expect(readShown(new URL(address).search)).toEqual({ ...shown, changes: shown.changes.trim() });
    expect(address).toContain('https://host/demo/?scene=icra2021');
    expect(address).toContain('colour=force');
  });

  it('opens the first scene where it says nothing, or nonsense', () => {
    expect(readShown('')).toEqual({ scene: 'moon', changes: '', eye: null });
    expect(readShown('?eye=1,2,x,4,5').eye).toBeNull();
    expect(readShown('?eye=1,2').eye).toBeNull();
  });
});
