// What the program and the page tell each other: docs/protocol.md, version 1.
//
// Text is JSON, with the types below. A binary message is a frame: 128 bytes, then runs, then one record of 8 bytes for
// each particle. Nothing of a frame is copied here; the arrays look into the message that came.

import { ProtocolError } from './protocol_error';
import { readStudyMessage, type StudyCommand, type StudyMessage } from './study/protocol';

export const PROTOCOL_VERSION = 1;
export const SUBPROTOCOL = 'haptolith.1';

export type Vec3 = [number, number, number];
/** w, x, y, z */
export type Quat = [number, number, number, number];

export interface Pose {
  position_m: Vec3;
  rotation: Quat;
}

export type Shape = 'box' | 'sphere' | 'plate' | 'jaws';
export const COLOUR_MODES = ['plain', 'force', 'speed', 'depth', 'sleep'] as const;
export type ColourMode = (typeof COLOUR_MODES)[number];

export interface PresetEntry {
  name: string;
  friction_coefficient: number;
}

export interface SoilEntry {
  name: string;
  source: string;
  friction_angle_deg: number;
  cohesion_pa: number;
  bulk_density_kg_m3: number;
}

export interface BodyEntry {
  name: string;
  gravity_m_s2: number;
}

export interface Hello {
  type: 'hello';
  protocol: number;
  version: string;
  client: number;
  /** pages may look on only */
  read_only: boolean;
  presets: PresetEntry[];
  soils: SoilEntry[];
  bodies: BodyEntry[];
  frictions: string[];
  shapes: string[];
  manoeuvres: string[];
}

export interface Slider {
  key: string;
  label: string;
  unit: string;
  value: number;
  low: number;
  high: number;
  step: number;
}

export interface Tool {
  shape: Shape;
  size_mm: Vec3;
  diameter_mm: number;
  thickness_mm: number;
  /** between jaws that are wide open */
  opening_mm: number;
}

export interface Box {
  width_m: number;
  length_m: number;
  surface_m: number;
  periodic_x: boolean;
  periodic_y: boolean;
}

export interface Range3 {
  low_m: Vec3;
  high_m: Vec3;
}

export interface Scene {
  type: 'scene';
  scene: number;
  title: string;
  particles: number;
  radius_m: number;
  size_spread: number;
  box: Box;
  quantised: Range3;
  soil: {
    preset: string | null;
    name: string | null;
    friction: string;
    friction_angle_deg: number | null;
    cohesion_pa: number | null;
    bulk_density_kg_m3: number;
  };
  sliders: Slider[];
  body: string | null;
  gravity_m_s2: Vec3;
  tool: Tool;
  hand: { manoeuvre: string; max_force_n: number; max_torque_nm: number };
  workspace: Range3;
}

export interface Status {
  type: 'status';
  time_s: number;
  ticks: number;
  misses: number;
  success_rate: number;
  rate_hz: number;
  tick_us: { p50: number; p99: number; max: number };
  particles: number;
  awake: number;
  paused: boolean;
  speed: number;
  held_by: number | null;
  clients: number;
  device: string;
  /** A person's hand is at the device: what changes the scene has to be confirmed. */
  person_feels: boolean;
  /** Why the hand at the device feels nothing just now. */
  let_go: string | null;
  real_time: { scheduler: string | null; memory_locked: boolean };
  simd: string;
  threads: number;
  busy: string | null;
  problem: string | null;
  can_undo: boolean;
  undo: string | null;
  recording: string | null;
  /** the last file that is finished, and where it is; an older program does not say */
  recorded?: { file: string; folder: string } | null;
}

export interface Reply {
  type: 'reply';
  /** null: that of the command was none */
  id: number | null;
  ok: boolean;
  error?: string;
}

export type Message = Hello | Scene | Status | Reply | StudyMessage;

export type Command =
  | { do: 'hold'; pose: [number, number, number, number, number, number, number] }
  | { do: 'release' | 'pause' | 'resume' }
  | { do: 'play'; manoeuvre: string }
  | FeltChange
  | { do: 'step'; ticks: number }
  | { do: 'speed'; factor: number }
  | { do: 'record'; on: boolean }
  | { do: 'colour'; by: ColourMode }
  | StudyCommand;

/** What a person at a device feels. */
export type FeltChange = ({ do: 'reset' | 'level' | 'undo' } | ({ do: 'scene' } & SceneChange)) & { confirmed?: true };

export function isFeltChange(command: Command): command is FeltChange {
  return ['reset', 'level', 'undo', 'scene'].includes(command.do);
}

export interface SceneChange {
  preset?: string;
  soil?: string;
  friction?: string;
  body?: string;
  tool?: Partial<Tool>;
  sliders?: Record<string, number>;
}

/** Text of a command; with `id` the program replies to it. */
export function encodeCommand(command: Command, id?: number): string {
  return JSON.stringify(id === undefined ? command : { id, ...command });
}

export { ProtocolError };

const MESSAGE_TYPES = new Set(['hello', 'scene', 'status', 'reply', 'study']);

/** Reads a JSON message; a type that this page does not know is null, so that later programs may add some. */
export function decodeMessage(text: string): Message | null {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    throw new ProtocolError('a message is not JSON');
  }
  if (typeof value !== 'object' || value === null || !('type' in value) || typeof value.type !== 'string')
    throw new ProtocolError('a message has no type');
  if (!MESSAGE_TYPES.has(value.type)) return null;
  if (value.type === 'hello' && (value as Hello).protocol !== PROTOCOL_VERSION)
    throw new ProtocolError(
      `the program speaks protocol ${String((value as Hello).protocol)}, this page ${PROTOCOL_VERSION}; reload the page`,
    );
  if (value.type === 'study') return readStudyMessage(value);
  return value as Message;
}

export const HEADER_BYTES = 128;
export const RUN_BYTES = 8;
export const RECORD_BYTES = 8;

const FRAME_KIND = 1;
const FLAG_PAUSED = 1;
const FLAG_HELD = 2;
const FLAG_WHOLE = 4;
const FLAG_FORCES = 8;

export interface FrameHeader {
  scene: number;
  time_s: number;
  paused: boolean;
  held: boolean;
  /** all particles are in this frame */
  whole: boolean;
  /** the records' contact forces are valid */
  forcesValid: boolean;
  tool: Pose;
  force_n: Vec3;
  torque_nm: Vec3;
  wished: Pose;
  longestTick_us: number;
  misses: number;
  awake: number;
  particles: number;
  number: number;
  /** between the tool's jaws; 0 with another tool */
  opening_m: number;
}

export interface Frame extends FrameHeader {
  /** first particle and count of each run, one after the other */
  runs: Uint32Array;
  /** four u16 a particle: x, y, z, and speed + 256 force; see `speedOf` and `contactForceOf` for the two bytes */
  records: Uint16Array;
}

function readVec3(view: DataView, at: number): Vec3 {
  return [view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true)];
}

function readPose(view: DataView, at: number): Pose {
  return {
    position_m: readVec3(view, at),
    rotation: [
      view.getFloat32(at + 12, true),
      view.getFloat32(at + 16, true),
      view.getFloat32(at + 20, true),
      view.getFloat32(at + 24, true),
    ],
  };
}

const allFinite = (...numbers: number[]): boolean => numbers.every(Number.isFinite);

/** Decodes a frame; throws ProtocolError on one that is damaged, before anything of it is used. */
export function decodeFrame(buffer: ArrayBuffer): Frame {
  if (buffer.byteLength < HEADER_BYTES) throw new ProtocolError(`a frame of ${buffer.byteLength} bytes has no header`);
  const view = new DataView(buffer);
  const kind = view.getUint8(0);
  const version = view.getUint8(1);
  if (kind !== FRAME_KIND) throw new ProtocolError(`a binary message of kind ${kind} is no frame`);
  if (version !== PROTOCOL_VERSION) throw new ProtocolError(`a frame of version ${version}`);

  const particles = view.getUint32(108, true);
  const run_count = view.getUint32(112, true);
  const record_count = view.getUint32(116, true);
  const expected_bytes = HEADER_BYTES + run_count * RUN_BYTES + record_count * RECORD_BYTES;
  if (buffer.byteLength !== expected_bytes)
    throw new ProtocolError(`a frame has ${buffer.byteLength} bytes instead of ${expected_bytes}`);

  const flags = view.getUint16(2, true);
  const frame: Frame = {
    scene: view.getUint32(4, true),
    time_s: view.getFloat64(8, true),
    paused: (flags & FLAG_PAUSED) !== 0,
    held: (flags & FLAG_HELD) !== 0,
    whole: (flags & FLAG_WHOLE) !== 0,
    forcesValid: (flags & FLAG_FORCES) !== 0,
    tool: readPose(view, 16),
    force_n: readVec3(view, 44),
    torque_nm: readVec3(view, 56),
    wished: readPose(view, 68),
    longestTick_us: view.getFloat32(96, true),
    misses: view.getUint32(100, true),
    awake: view.getUint32(104, true),
    particles,
    number: view.getUint32(120, true),
    opening_m: view.getFloat32(124, true),
    // Header and runs are multiples of 8 bytes, so the views are aligned. They read in the machine's byte order, which
    // is little-endian wherever browsers run.
    runs: new Uint32Array(buffer, HEADER_BYTES, run_count * 2),
    records: new Uint16Array(buffer, HEADER_BYTES + run_count * RUN_BYTES, record_count * 4),
  };
  if (
    !allFinite(frame.time_s, frame.longestTick_us, frame.opening_m, ...frame.force_n, ...frame.torque_nm) ||
    !allFinite(...frame.tool.position_m, ...frame.tool.rotation) ||
    !allFinite(...frame.wished.position_m, ...frame.wished.rotation)
  )
    throw new ProtocolError('a frame holds a number that is not finite');

  let records_in_runs = 0;
  for (let i = 0; i < frame.runs.length; i += 2) {
    const first = frame.runs[i]!;
    const count = frame.runs[i + 1]!;
    if (first + count > particles) throw new ProtocolError(`a run ends at ${first + count} of ${particles} particles`);
    records_in_runs += count;
  }
  if (records_in_runs !== record_count)
    throw new ProtocolError(`the runs hold ${records_in_runs} records instead of ${record_count}`);
  return frame;
}

/** Position along one axis in m. */
export function dequantise(value: number, low_m: number, high_m: number): number {
  return low_m + (value / 65535) * (high_m - low_m);
}

/** Speed in m/s of a record's speed byte; 0 when asleep. */
export function speedOf(byte: number): number {
  return byte === 0 ? 0 : 10 ** (-4 + (4 * (byte - 1)) / 254);
}

/** Contact force in N of a record's force byte. */
export function contactForceOf(byte: number): number {
  return byte === 0 ? 0 : 10 ** (-5 + (6 * (byte - 1)) / 254);
}
