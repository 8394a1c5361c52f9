// Writes frames as specified in docs/reference/web-messages.md, for tests and for the mock: the inverse of decodeFrame.

import type { FrameHeader, Pose, ToolState } from 'haptolith-protocol';

export interface RecordValues {
  x: number;
  y: number;
  z: number;
  speed: number;
  force: number;
}

export function encodeFrame(
  header: FrameHeader,
  runs: [first: number, count: number][],
  records: RecordValues[],
  stones: Pose[] = [],
  tools: ToolState[] = [],
): ArrayBuffer {
  const stones_at = 128 + 8 * runs.length + 8 * records.length;
  const tools_at = stones_at + (stones.length > 0 ? 4 + 28 * stones.length : 0);
  const buffer = new ArrayBuffer(tools_at + (tools.length > 0 ? 4 + 116 * tools.length : 0));
  const view = new DataView(buffer);
  const f32 = (at: number, values: readonly number[]): void =>
    values.forEach((value, i) => view.setFloat32(at + 4 * i, value, true));
  view.setUint8(0, 1);
  view.setUint8(1, 1);
  const flags = [header.paused, header.held, header.whole, header.forcesValid, stones.length > 0, tools.length > 0];
  view.setUint16(
    2,
    flags.reduce((sum, flag, bit) => sum + Number(flag) * 2 ** bit, 0),
    true,
  );
  view.setUint32(4, header.scene, true);
  view.setFloat64(8, header.time_s, true);
  f32(16, [...header.tool.position_m, ...header.tool.rotation]);
  f32(44, [...header.force_n, ...header.torque_nm]);
  f32(68, [...header.wished.position_m, ...header.wished.rotation]);
  f32(96, [header.longestTick_us]);
  view.setUint32(100, header.misses, true);
  view.setUint32(104, header.awake, true);
  view.setUint32(108, header.particles, true);
  view.setUint32(112, runs.length, true);
  view.setUint32(116, records.length, true);
  view.setUint32(120, header.number, true);
  f32(124, [header.opening_m]);
  let at = 128;
  for (const [first, count] of runs) {
    view.setUint32(at, first, true);
    view.setUint32(at + 4, count, true);
    at += 8;
  }
  for (const { x, y, z, speed, force } of records) {
    [x, y, z].forEach((value, axis) => view.setUint16(at + 2 * axis, value, true));
    view.setUint8(at + 6, speed);
    view.setUint8(at + 7, force);
    at += 8;
  }
  if (stones.length > 0) view.setUint32(stones_at, stones.length, true);
  stones.forEach(({ position_m, rotation }, i) => f32(stones_at + 4 + 28 * i, [...position_m, ...rotation]));
  if (tools.length > 0) view.setUint32(tools_at, tools.length, true);
  tools.forEach(({ turned, hub, force_n, torque_nm, wished, opening_m, held_by }, i) => {
    const poses = (...all: Pose[]): number[] => all.flatMap(({ position_m, rotation }) => [...position_m, ...rotation]);
    const tool_at = tools_at + 4 + 116 * i;
    f32(tool_at, [...poses(turned, hub), ...force_n, ...torque_nm, ...poses(wished), opening_m]);
    view.setUint32(tool_at + 112, held_by, true);
  });
  return buffer;
}
