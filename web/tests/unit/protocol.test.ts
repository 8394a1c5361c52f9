import {
  contactForceOf,
  decodeFrame,
  decodeMessage,
  dequantise,
  encodeCommand,
  type Frame,
  type FrameHeader,
  isSameTool,
  type Pose,
  ProtocolError,
  type Scene,
  speedOf,
  type ToolState,
} from 'haptolith-protocol';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { describe, expect, it } from 'vitest';
import { encodeFrame } from '../frame-bytes';
import { encodeMesh, SCOOP } from '../scoop';

const HEADER: FrameHeader = {
  scene: 3,
  time_s: 12.25,
  paused: false,
  held: true,
  whole: false,
  forcesValid: true,
  tool: { position_m: [0.5, -0.25, 0.125], rotation: [1, 0, 0, 0] },
  force_n: [1, 2, -3],
  torque_nm: [0.5, 0.25, -0.125],
  wished: { position_m: [0, 0, 1], rotation: [0, 1, 0, 0] },
  longestTick_us: 40.5,
  misses: 7,
  awake: 3,
  particles: 10,
  number: 99,
  opening_m: 0.0625,
};

const RECORDS = [
  { x: 0, y: 65535, z: 256, speed: 0, force: 255 },
  { x: 1, y: 2, z: 3, speed: 4, force: 5 },
  { x: 6, y: 7, z: 8, speed: 255, force: 0 },
];

const STONES: Pose[] = [
  { position_m: [0.5, 0.25, -0.125], rotation: [0.5, -0.5, 0.5, -0.5] },
  { position_m: [1, 2, 4], rotation: [1, 0, 0, 0] },
];

const TOOLS: ToolState[] = [
  {
    turned: { position_m: [0.5, 0.25, -0.125], rotation: [0.5, -0.5, 0.5, -0.5] },
    hub: { position_m: [0.5, 0.25, -0.125], rotation: [1, 0, 0, 0] },
    force_n: [4, 5, -6],
    torque_nm: [0.25, 0.5, -0.75],
    wished: { position_m: [0, 0, 2], rotation: [0, 0, 1, 0] },
    opening_m: 0.0625,
    held_by: 3,
  },
  {
    turned: STONES[1]!,
    hub: STONES[1]!,
    force_n: [0, 0, 0],
    torque_nm: [0, 0, 0],
    wished: STONES[0]!,
    opening_m: 0,
    held_by: 0,
  },
];

describe('a frame', () => {
  it('is read as it was written', () => {
    const frame = decodeFrame(encodeFrame(HEADER, [[0, 1], [8, 2]], RECORDS)); // prettier-ignore
    expect(frame).toMatchObject(HEADER);
    expect([...frame.runs]).toEqual([0, 1, 8, 2]);
    expect([...frame.records.subarray(0, 4)]).toEqual([0, 65535, 256, 255 * 256]);
    expect([...frame.records.subarray(4, 8)]).toEqual([1, 2, 3, 4 + 5 * 256]);
  });

  it('says where stones are when there are any', () => {
    const of = (stones: Pose[]): number[] => [...decodeFrame(encodeFrame(HEADER, [[0, 3]], RECORDS, stones)).stones];
    expect(of([])).toEqual([]);
    expect(of(STONES)).toEqual([0.5, 0.25, -0.125, 0.5, -0.5, 0.5, -0.5, 1, 2, 4, 1, 0, 0, 0]);
  });

  it.each([[[]], [STONES]])('has every tool after the stones', (stones) => {
    const frame = decodeFrame(encodeFrame(HEADER, [[0, 3]], RECORDS, stones, TOOLS));
    expect(frame.tools).toEqual(TOOLS);
    expect(frame.stones.length).toBe(7 * stones.length);
    expect(decodeFrame(encodeFrame(HEADER, [[0, 3]], RECORDS, stones)).tools).toEqual([]);
  });

  it('is read from bytes written by hand', () => {
    const bytes = new Uint8Array(128 + 8 + 8);
    bytes.set([1, 1, 5, 0, 2, 0, 0, 0]); // frame, version 1, paused and whole, scene 2
    bytes.set([0, 0, 0, 0, 0, 0, 0xf8, 0x3f], 8); // 1.5 s
    bytes.set([0, 0, 0x80, 0x3f], 28); // w of the tool's rotation = 1
    bytes.set([0, 0, 0, 0xc0], 52); // force z = -2 N
    bytes.set([1, 0, 0, 0], 108); // particles
    bytes.set([1, 0, 0, 0], 112); // runs
    bytes.set([1, 0, 0, 0], 116); // records
    bytes.set([0, 0, 0, 0, 1, 0, 0, 0], 128); // particles 0 to 0
    bytes.set([0x34, 0x12, 0xff, 0xff, 0, 0, 9, 10], 136);
    const frame = decodeFrame(bytes.buffer);
    expect(frame.paused && frame.whole && !frame.held && !frame.forcesValid).toBe(true);
    expect(frame.scene).toBe(2);
    expect(frame.time_s).toBe(1.5);
    expect(frame.tool.rotation).toEqual([1, 0, 0, 0]);
    expect(frame.force_n).toEqual([0, 0, -2]);
    expect([...frame.records]).toEqual([0x1234, 0xffff, 0, 9 + 256 * 10]);
  });

  it('looks into the message instead of copying it', () => {
    const buffer = encodeFrame(HEADER, [[0, 3]], RECORDS);
    expect(decodeFrame(buffer).records.buffer).toBe(buffer);
  });

  it.each<[string, (bytes: Uint8Array, view: DataView) => void]>([
    ['another kind', (bytes) => (bytes[0] = 2)],
    ['another version', (bytes) => (bytes[1] = 2)],
    ['more runs than bytes', (_, view) => view.setUint32(112, 2, true)],
    ['fewer records than bytes', (_, view) => view.setUint32(116, 2, true)],
    ['an enormous count of records', (_, view) => view.setUint32(116, 0xffffffff, true)],
    ['a run beyond the last particle', (_, view) => view.setUint32(128, 8, true)],
    ['a run whose end does not fit into 32 bits', (_, view) => view.setUint32(128, 0xffffffff, true)],
    ['a run of another length than its records', (_, view) => view.setUint32(132, 2, true)],
    ['a force that is not finite', (_, view) => view.setFloat32(44, NaN, true)],
    ['a pose that is not finite', (_, view) => view.setFloat32(16, Infinity, true)],
    ['more stones than bytes', (_, view) => view.setUint32(160, 3, true)],
    ['an enormous count of stones', (_, view) => view.setUint32(160, 0xffffffff, true)],
    ['stones of which it says nothing', (bytes) => (bytes[2]! &= ~16)],
    ['a stone at a place that is not finite', (_, view) => view.setFloat32(164, NaN, true)],
    ['an enormous count of tools', (_, view) => view.setUint32(220, 0xffffffff, true)],
    ['tools of which it says nothing', (bytes) => (bytes[2]! &= ~32)],
    ['a tool at a place that is not finite', (_, view) => view.setFloat32(224, NaN, true)],
  ])('with %s is refused', (_name, damage) => {
    const buffer = encodeFrame(HEADER, [[0, 3]], RECORDS, STONES, TOOLS);
    damage(new Uint8Array(buffer), new DataView(buffer));
    expect(() => decodeFrame(buffer)).toThrow(ProtocolError);
  });

  it.each<[Pose[], ToolState[]]>([
    [[], []],
    [STONES, []],
    [STONES, TOOLS],
  ])('of any shorter length is refused', (stones, tools) => {
    // prettier-ignore
    const buffer = encodeFrame(HEADER, [[0, 3]], RECORDS, stones, tools);
    for (let length = 0; length < buffer.byteLength; ++length)
      expect(() => decodeFrame(buffer.slice(0, length))).toThrow(ProtocolError);
  });
});

// The program's tests write these bytes: Frame.HasTheBytesThatThePageIsTestedWith in tests/viewer/frame_test.cpp.
function sharedFrame(file: string): Frame {
  const bytes = readFileSync(fileURLToPath(new URL(`../../../tests/data/${file}`, import.meta.url)));
  return decodeFrame(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) as ArrayBuffer);
}

describe('the frame that the program is tested against', () => {
  const frame = sharedFrame('frame-v1.bin');
  const single = (values: number[]): number[] => Array.from(new Float32Array(values));

  it('says what the program meant', () => {
    expect(frame).toMatchObject({ scene: 7, time_s: 12.345, paused: true, held: true, whole: true, forcesValid: true });
    expect(frame).toMatchObject({ longestTick_us: 17.5, misses: 2, awake: 32, particles: 40, number: 100 });
    expect(frame.tool.position_m).toEqual(single([0.01, -0.02, 0.03]));
    expect(frame.tool.rotation).toEqual(single([Math.SQRT1_2, 0, Math.SQRT1_2, 0]));
    expect(frame.force_n).toEqual([1, -2, 3]);
    expect(frame.torque_nm).toEqual(single([0.01, 0.02, -0.03]));
    expect(frame.wished.position_m).toEqual(single([0, 0, 0.1]));
    expect(Array.from(frame.runs)).toEqual([0, 40]);
  });

  it('has stones after what it is without', () => {
    const { stones, ...rest } = sharedFrame('frame-v1-stones.bin');
    expect({ ...rest, stones: new Float32Array() }).toEqual(frame);
    expect([...stones]).toEqual([...single([0.01, -0.02, 0.03]), 0.5, -0.5, 0.5, -0.5, ...single([0.04, 0, 0.05, 1, 0, 0, 0])]); // prettier-ignore
  });

  it('has tools after the stones', () => {
    const { tools, ...rest } = sharedFrame('frame-v1-tools.bin');
    expect({ ...rest, tools: [] }).toEqual(sharedFrame('frame-v1-stones.bin'));
    expect(tools[0]).toMatchObject({ hub: frame.tool, turned: frame.tool, opening_m: 0.0625, held_by: 0 });
    expect(tools[1]).toMatchObject({ force_n: [4, 5, -6], opening_m: 0, held_by: 3 });
    expect(tools[1]!.turned.rotation).toEqual([0.5, -0.5, 0.5, -0.5]);
    expect(tools[1]!.wished.position_m).toEqual(single([0.04, 0, 0.04]));
  });

  it('has bands after the tools', () => {
    const { bands, ...rest } = sharedFrame('frame-v1-bands.bin');
    expect({ ...rest, bands: [] }).toEqual(sharedFrame('frame-v1-tools.bin'));
    expect(bands).toEqual([{ low_n: 1.5, high_n: 3.25 }, null]);
  });

  it('shows every grain where it is', () => {
    for (let i = 0; i < 40; ++i) {
      const [x, y, z, state] = frame.records.subarray(4 * i, 4 * i + 4) as unknown as [number, number, number, number];
      expect(dequantise(x, -0.1, 0.1)).toBeCloseTo(-0.1 + (0.2 * i) / 40, 5);
      expect(dequantise(y, -0.1, 0.1)).toBeCloseTo(0.05, 5);
      expect(dequantise(z, 0, 0.5)).toBeCloseTo((0.1 * i) / 40, 5);
      expect(state & 0xff).toBe(i < 32 ? 1 : 0); // the last group sleeps
      expect(contactForceOf(state >> 8)).toBeCloseTo(0.5, 1);
    }
  });
});

describe('the bytes of a record', () => {
  it('span 0.1 mm/s to 1 m/s', () => {
    expect(speedOf(0)).toBe(0);
    expect(speedOf(1)).toBeCloseTo(1e-4, 12);
    expect(speedOf(255)).toBeCloseTo(1, 12);
  });

  it('span 10 uN to 10 N', () => {
    expect(contactForceOf(0)).toBe(0);
    expect(contactForceOf(1)).toBeCloseTo(1e-5, 12);
    expect(contactForceOf(255)).toBeCloseTo(10, 12);
  });

  it('span the quantised box', () => {
    expect(dequantise(0, -0.2, 0.2)).toBe(-0.2);
    expect(dequantise(65535, -0.2, 0.2)).toBeCloseTo(0.2, 15);
  });
});

describe('a message', () => {
  it('of a type that is not known is left out', () => {
    expect(decodeMessage('{"type": "news"}')).toBeNull();
  });

  it('that is not JSON, or has no type, is refused', () => {
    for (const text of ['', '{', '7', 'null', '{}', '{"type": 3}'])
      expect(() => decodeMessage(text)).toThrow(ProtocolError);
  });

  it('of another protocol is refused', () => {
    expect(() => decodeMessage('{"type": "hello", "protocol": 2}')).toThrow(/reload/);
  });
});

// "..." abbreviates lists. Messages begin at an indentation of four spaces and continue at five or more.
const DOCUMENT = ['web-messages.md', 'web-protocol.md']
  .map((page) => readFileSync(fileURLToPath(new URL(`../../../docs/reference/${page}`, import.meta.url)), 'utf8'))
  .join('\n');
const EXAMPLES = (DOCUMENT.match(/^ {4}\{"type".*(?:\n {5,}.*)*/gm) ?? []).map((text) => text.replaceAll(', ...', ''));
const example = (type: string): Record<string, unknown> =>
  JSON.parse(EXAMPLES.find((text) => text.includes(`{"type": "${type}"`))!) as Record<string, unknown>;

describe("the document's messages", () => {
  it.each(EXAMPLES)('are what the page reads: %.45s', (text) => {
    expect(decodeMessage(text)).toMatchObject(JSON.parse(text) as object);
  });

  it('are all that there are', () => {
    const types = EXAMPLES.map((text) => decodeMessage(text)!.type);
    expect(types).toEqual(['hello', 'scene', 'status', 'reply', 'reply', 'study', 'study']);
  });
});

describe('a message of another program', () => {
  const read = (type: string, change: object) => decodeMessage(JSON.stringify({ ...example(type), ...change }));

  it('may say more, which is left out', () => {
    const status = read('status', { temperature_k: 300, tick_us: { p50: 1, p99: 2, max: 3, p999: 4 } });
    expect(status).toMatchObject({ type: 'status', tick_us: { p50: 1, p99: 2, max: 3 } });
    expect(status).not.toHaveProperty('temperature_k');
  });

  it('may know fewer sizes of a tool and shapes that the page does not', () => {
    const { length_mm: _, ...older } = example('scene').tool as Record<string, unknown>;
    expect(read('scene', { tool: older })).toMatchObject({ tool: { shape: 'box', length_mm: 0 } });
    expect(read('scene', { tool: { ...older, shape: 'cylinder', length_mm: 150 } })).toMatchObject({
      tool: { shape: 'cylinder', length_mm: 150 },
    });
    expect(read('hello', { shapes: ['box', 'spiral', 'cylinder'] })).toMatchObject({ shapes: ['box', 'cylinder'] });
  });

  it('of version 0.2 calls a friction model otherwise', () => {
    const soil = { ...(example('scene').soil as object), friction: 'paper' };
    expect(read('scene', { soil })).toMatchObject({ soil: { friction: 'icra2021' } });
    expect(read('hello', { frictions: ['paper', 'contact'] })).toMatchObject({ frictions: ['icra2021', 'contact'] });
  });

  it('tells a participant nothing of the soil', () => {
    const { soil } = example('scene');
    const hidden = Object.fromEntries(Object.keys(soil as object).map((key) => [key, null]));
    expect(read('scene', { soil: hidden, sliders: [], body: null })).toMatchObject({ soil: hidden });
  });

  it.each([
    ['hello', { soils: [{ name: 'sand' }] }, 'hello.soils[0].source is missing'],
    ['scene', { particles: '256' }, 'scene.particles is not valid: must be number'],
    ['scene', { gravity_m_s2: [0, 0] }, 'scene.gravity_m_s2[2] is missing'],
    ['scene', { tool: { shape: 'spiral' } }, 'scene.tool.shape is not valid: must be ("box" | "sphere"'],
    ['status', { held_by: 'me' }, 'status.held_by is not valid'],
    ['status', { tick_us: null }, 'status.tick_us is not valid'],
    ['reply', { ok: 1 }, 'reply.ok is not valid: must be boolean'],
  ])('%s that is wrong is refused, and says where: %#', (type, change, where) => {
    expect(() => read(type, change)).toThrow(ProtocolError);
    expect(() => read(type, change)).toThrow(where);
  });
});

describe('a mesh', () => {
  const read = (mesh: unknown, shape = 'box'): Scene => {
    const scene = example('scene');
    return decodeMessage(JSON.stringify({ ...scene, tool: { ...(scene.tool as object), shape, mesh } })) as Scene;
  };
  const base64 = (...bytes: number[]): string => Buffer.from(bytes).toString('base64');

  it('is read from bytes written by hand', () => {
    const points_base64 = base64(0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0, 0, 0, 0, 0);
    const triangles_base64 = base64(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    const { mesh } = read({ name: 'one.stl', points_base64, triangles_base64 }).tool;
    expect(mesh).toEqual({
      name: 'one.stl',
      report: [],
      points_m: new Float32Array([1, -2, 0]),
      triangles: new Uint32Array([0, 0, 0]),
    });
  });

  it('may be missing while the tool is another', () => {
    expect(read(undefined).tool.mesh).toBeNull();
    expect(read(null).tool.mesh).toBeNull();
    for (const none of [null, undefined])
      expect(() => read(none, 'mesh')).toThrow('scene.tool.mesh is not valid: must be there for a tool of this shape');
    expect(read(SCOOP, 'mesh').tool).toMatchObject({ shape: 'mesh', mesh: { name: 'scoop.stl' } });
  });

  it('stays the same object until it changes', () => {
    const { tool } = read(SCOOP);
    expect(read(SCOOP).tool.mesh).toBe(tool.mesh);
    expect(isSameTool(read(SCOOP).tool, tool)).toBe(true);
    expect(isSameTool(read(SCOOP, 'mesh').tool, tool)).toBe(false);
    expect(isSameTool(read({ ...SCOOP, name: 'other.stl' }).tool, tool)).toBe(false);
    expect(isSameTool(read(null).tool, tool)).toBe(false);
  });

  it.each([
    [{ points_base64: '%' }, '.points_base64 is not valid: must be base64 of 12 bytes a point'],
    [{ points_base64: base64(1, 2, 3, 4) }, '.points_base64 is not valid: must be base64 of 12 bytes a point'],
    [{ points_base64: '' }, '.points_base64 is not valid: must be base64 of 12 bytes a point'],
    [{ points_base64: encodeMesh('', [[0, NaN, 0]], []).points_base64 }, '.points_base64 is not valid: must be finite'],
    [{ triangles_base64: base64(0, 0, 0, 0) }, '.triangles_base64 is not valid: must be base64 of 12 bytes a triangle'],
    [
      { triangles_base64: encodeMesh('', [], [[0, 1, 16]]).triangles_base64 },
      '.triangles_base64 is not valid: must be of 16 points',
    ],
    [{ name: 7 }, '.name is not valid: must be string'],
    [{ triangles_base64: undefined }, '.triangles_base64 is missing'],
  ])('that is wrong is refused, and says where: %#', (change, where) => {
    expect(() => read({ ...SCOOP, ...change })).toThrow(ProtocolError);
    expect(() => read({ ...SCOOP, ...change })).toThrow(`scene.tool.mesh${where}`);
  });
});

describe('stones', () => {
  const read = (stones: unknown) => (decodeMessage(JSON.stringify({ ...example('scene'), stones })) as Scene).stones;
  const { name: _, ...text } = SCOOP;

  it('are meshes or spheres, or none', () => {
    expect(read(undefined)).toBeUndefined();
    const [mesh, spheres] = read([text, { spheres: [[0.01, -0.02, 0, 0.03]] }])!;
    expect(mesh).toMatchObject({ points_m: { length: 48 } });
    expect(spheres).toEqual({ spheres: [[0.01, -0.02, 0, 0.03]] });
  });

  it.each([
    [{}],
    [{ ...text, points_base64: '%' }],
    [{ ...text, triangles_base64: undefined }],
    [{ spheres: [] }],
    [{ spheres: [[0, 0, 0]] }],
    [{ spheres: [[0, 0, 0, -1]] }],
  ])('that are wrong are refused, and it is said where: %#', (stone) => {
    expect(() => read([text, stone])).toThrow('scene.stones[1]');
  });
});

describe('a command', () => {
  it('has an id only when a reply is wanted', () => {
    expect(JSON.parse(encodeCommand({ do: 'scene', body: 'Mars' }, 17))).toEqual({ id: 17, do: 'scene', body: 'Mars' });
    expect(JSON.parse(encodeCommand({ do: 'release' }))).toEqual({ do: 'release' });
  });
});
