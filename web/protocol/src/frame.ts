// A binary message is a frame: 128 bytes, then runs, then a record of 8 bytes per particle, then the poses of stones and
// the tools, if any. Nothing is copied here; the arrays are views of the received message.

import type { Pose, Vec3 } from './pose.js';
import { ProtocolError } from './protocol_error.js';
import { PROTOCOL_VERSION } from './version.js';

export const HEADER_BYTES = 128;
export const RUN_BYTES = 8;
export const RECORD_BYTES = 8;
export const STONE_BYTES = 28;
export const TOOL_BYTES = 116;
export const BAND_BYTES = 8;

const FRAME_KIND = 1;
const FLAG_PAUSED = 1;
const FLAG_HELD = 2;
const FLAG_WHOLE = 4;
const FLAG_FORCES = 8;
const FLAG_STONES = 16;
const FLAG_TOOLS = 32;
const FLAG_BANDS = 64;

export interface FrameHeader {
  scene: number;
  time_s: number;
  paused: boolean;
  held: boolean;
  /** whether the frame contains all particles */
  whole: boolean;
  /** whether the records' contact forces are valid */
  forcesValid: boolean;
  tool: Pose;
  /** commanded device force in the scene's axes, unscaled, N; in an animation file the soil force on the tool, scene
   * frame */
  force_n: Vec3;
  /** torque of the same wrench about the handle's origin, N m; in an animation file about the tool's origin */
  torque_nm: Vec3;
  wished: Pose;
  longestTick_us: number;
  misses: number;
  awake: number;
  particles: number;
  number: number;
  /** gap between the tool's jaws; 0 for another tool */
  opening_m: number;
}

/** One of several tools, or one that a joint turns. */
export interface ToolState {
  /** pose of the tool as its joint has turned it: where its shape is */
  turned: Pose;
  /** pose of its hub, which a hand holds */
  hub: Pose;
  /** as in `FrameHeader` */
  force_n: Vec3;
  torque_nm: Vec3;
  wished: Pose;
  opening_m: number;
  /** number of the client that holds it; 0: none */
  held_by: number;
}

/** Range, with a probability of 90 %, of the mean soil force over the last 0.25 s in another specimen of the soil with
 * particles half as large, N. */
export interface ForceBand {
  low_n: number;
  high_n: number;
}

export interface Frame extends FrameHeader {
  /** first particle and count of each run, in sequence */
  runs: Uint32Array;
  /** four u16 per particle: x, y, z, and speed + 256 force; `speedOf` and `contactForceOf` decode the two bytes */
  records: Uint16Array;
  /** pose of each stone, seven numbers: x, y, z in m, rotation w, x, y, z */
  stones: Float32Array;
  /** every tool, in the order of the scene's `tools`; empty without those */
  tools: ToolState[];
  /** one per tool, null where it is not known; empty where none is */
  bands: (ForceBand | null)[];
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

function readTool(view: DataView, at: number): ToolState {
  return {
    turned: readPose(view, at),
    hub: readPose(view, at + 28),
    force_n: readVec3(view, at + 56),
    torque_nm: readVec3(view, at + 68),
    wished: readPose(view, at + 80),
    opening_m: view.getFloat32(at + 108, true),
    held_by: view.getUint32(at + 112, true),
  };
}

function readBand(view: DataView, at: number): ForceBand | null {
  const low_n = view.getFloat32(at, true);
  const high_n = view.getFloat32(at + 4, true);
  return high_n < low_n ? null : { low_n, high_n };
}

const isPoseFinite = ({ position_m, rotation }: Pose): boolean => allFinite(...position_m, ...rotation);

const isToolFinite = (tool: ToolState): boolean =>
  [tool.turned, tool.hub, tool.wished].every(isPoseFinite) &&
  allFinite(...tool.force_n, ...tool.torque_nm, tool.opening_m);

const allFinite = (...numbers: number[]): boolean => numbers.every(Number.isFinite);

/** Decodes a frame. @throws ProtocolError if it is damaged, before any of it is used. */
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
  const flags = view.getUint16(2, true);
  const stones_at = HEADER_BYTES + run_count * RUN_BYTES + record_count * RECORD_BYTES;
  let expected_bytes = stones_at;
  let stone_count = 0;
  if (flags & FLAG_STONES) {
    if (buffer.byteLength >= stones_at + 4) stone_count = view.getUint32(stones_at, true);
    expected_bytes += 4 + stone_count * STONE_BYTES;
  }
  const tools_at = expected_bytes;
  let tool_count = 0;
  if (flags & FLAG_TOOLS) {
    if (buffer.byteLength >= tools_at + 4) tool_count = view.getUint32(tools_at, true);
    expected_bytes += 4 + tool_count * TOOL_BYTES;
  }
  const bands_at = expected_bytes;
  let band_count = 0;
  if (flags & FLAG_BANDS) {
    if (buffer.byteLength >= bands_at + 4) band_count = view.getUint32(bands_at, true);
    expected_bytes += 4 + band_count * BAND_BYTES;
  }
  if (buffer.byteLength !== expected_bytes)
    throw new ProtocolError(`a frame has ${buffer.byteLength} bytes instead of ${expected_bytes}`);

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
    // Header and runs are multiples of 8 bytes, so the views are aligned. They use the machine's byte order, which is
    // little-endian wherever browsers run.
    runs: new Uint32Array(buffer, HEADER_BYTES, run_count * 2),
    records: new Uint16Array(buffer, HEADER_BYTES + run_count * RUN_BYTES, record_count * 4),
    stones: stone_count > 0 ? new Float32Array(buffer, stones_at + 4, stone_count * 7) : new Float32Array(),
    tools: Array.from({ length: tool_count }, (_, i) => readTool(view, tools_at + 4 + i * TOOL_BYTES)),
    bands: Array.from({ length: band_count }, (_, i) => readBand(view, bands_at + 4 + i * BAND_BYTES)),
  };
  if (
    !allFinite(frame.time_s, frame.longestTick_us, frame.opening_m, ...frame.force_n, ...frame.torque_nm) ||
    !isPoseFinite(frame.tool) ||
    !isPoseFinite(frame.wished) ||
    !frame.stones.every(Number.isFinite) ||
    !frame.tools.every(isToolFinite) ||
    !frame.bands.every((band) => band === null || allFinite(band.low_n, band.high_n))
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

/** Returns the position along one axis in m. */
export function dequantise(value: number, low_m: number, high_m: number): number {
  return low_m + (value / 65535) * (high_m - low_m);
}

/** Returns the speed in m/s of a record's speed byte; 0 when asleep. */
export function speedOf(byte: number): number {
  return byte === 0 ? 0 : 10 ** (-4 + (4 * (byte - 1)) / 254);
}

/** Returns the contact force in N of a record's force byte. */
export function contactForceOf(byte: number): number {
  return byte === 0 ? 0 : 10 ** (-5 + (6 * (byte - 1)) / 254);
}
