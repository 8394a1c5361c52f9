// Messages of the program: docs/reference/web-messages.md, version 1.
//
// Text is JSON. The schemas below check each message and define its types. Unnamed keys are dropped, so that later
// programs may add keys.

import * as v from 'valibot';
import { Vec3 } from './pose.js';
import { ProtocolError } from './protocol_error.js';
import { Stone } from './stone.js';
import { StudyMessage } from './study.js';
import { ToolMesh } from './tool_mesh.js';
import { PROTOCOL_VERSION } from './version.js';

const Shape = v.picklist(['box', 'sphere', 'plate', 'cylinder', 'jaws', 'mesh']);
export type Shape = v.InferOutput<typeof Shape>;

/** `paper` of version 0.2 and earlier is read as `icra2021`. */
const FrictionModel = v.pipe(
  v.string(),
  v.transform((word) => (word === 'paper' ? 'icra2021' : word)),
);

const Hello = v.object({
  type: v.literal('hello'),
  protocol: v.literal(PROTOCOL_VERSION),
  version: v.string(),
  client: v.number(),
  /** pages may only watch */
  read_only: v.boolean(),
  /** a tool may be uploaded; absent from older programs, which accept none */
  takes_uploads: v.optional(v.boolean(), false),
  presets: v.array(v.object({ name: v.string(), friction_coefficient: v.number() })),
  soils: v.array(
    v.object({
      name: v.string(),
      source: v.string(),
      friction_angle_deg: v.number(),
      cohesion_pa: v.number(),
      bulk_density_kg_m3: v.number(),
    }),
  ),
  bodies: v.array(v.object({ name: v.string(), gravity_m_s2: v.number() })),
  frictions: v.array(FrictionModel),
  /** those that this page can draw */
  shapes: v.pipe(
    v.array(v.string()),
    v.transform((names) => names.filter((name): name is Shape => v.is(Shape, name))),
  ),
  motions: v.array(v.string()),
});
export type Hello = v.InferOutput<typeof Hello>;

const Slider = v.object({
  key: v.string(),
  label: v.string(),
  unit: v.string(),
  value: v.number(),
  low: v.number(),
  high: v.number(),
  step: v.number(),
});
export type Slider = v.InferOutput<typeof Slider>;

const TOOL_KEYS = {
  shape: Shape,
  size_mm: Vec3,
  diameter_mm: v.number(),
  thickness_mm: v.number(),
  /** length of a cylinder; absent from older programs, which have none */
  length_mm: v.optional(v.number(), 0),
  /** gap between fully open jaws */
  opening_mm: v.number(),
  /** bend of each jaw; absent from older programs, whose jaws are flat */
  jaw_bend_deg: v.optional(v.number(), 0),
  /** independent of the current shape; null: no mesh has been loaded */
  mesh: v.nullish(ToolMesh, null),
};
const MESH_RULE = 'there for a tool of this shape';
const hasItsMesh = (shape: Shape, mesh: ToolMesh | null): boolean => shape !== 'mesh' || mesh !== null;

const Tool = v.pipe(
  v.object(TOOL_KEYS),
  v.forward(
    v.check(({ shape, mesh }) => hasItsMesh(shape, mesh), MESH_RULE),
    ['mesh'],
  ),
);
export type Tool = v.InferOutput<typeof Tool>;

/** One of several tools, or one that a joint turns. */
const NamedTool = v.pipe(
  v.object({
    /** empty for a participant of a study (blinding) */
    name: v.string(),
    /** motion of its virtual hand */
    motion: v.string(),
    ...TOOL_KEYS,
  }),
  v.forward(
    v.check(({ shape, mesh }) => hasItsMesh(shape, mesh), MESH_RULE),
    ['mesh'],
  ),
);
export type NamedTool = v.InferOutput<typeof NamedTool>;

/** Whether two tools have equal numbers; meshes are too large to compare and are equal only if identical. */
export function isSameTool({ mesh: a, ...one }: Tool, { mesh: b, ...other }: Tool): boolean {
  return a === b && JSON.stringify(one) === JSON.stringify(other);
}

const Range3 = v.object({ low_m: Vec3, high_m: Vec3 });
export type Range3 = v.InferOutput<typeof Range3>;

const Scene = v.object({
  type: v.literal('scene'),
  scene: v.number(),
  title: v.string(),
  particles: v.number(),
  /** radius of the coarsest particles */
  radius_m: v.number(),
  /** Whether `coarser` has a coarser soil for this scene; absent from older programs. */
  can_coarsen: v.optional(v.boolean(), false),
  /** number and radius of each size, in the order of a frame's particles; absent from older programs, which have one
   * size */
  grains: v.optional(v.array(v.object({ count: v.number(), radius_m: v.number() }))),
  size_spread: v.number(),
  box: v.object({
    width_m: v.number(),
    length_m: v.number(),
    surface_m: v.number(),
    periodic_x: v.boolean(),
    periodic_y: v.boolean(),
  }),
  quantised: Range3,
  /** all null for a participant of a study (blinding) */
  soil: v.object({
    preset: v.nullable(v.string()),
    name: v.nullable(v.string()),
    friction: v.nullable(FrictionModel),
    friction_angle_deg: v.nullable(v.number()),
    cohesion_pa: v.nullable(v.number()),
    bulk_density_kg_m3: v.nullable(v.number()),
  }),
  sliders: v.array(Slider),
  body: v.nullable(v.string()),
  gravity_m_s2: Vec3,
  tool: Tool,
  /** every tool, the first included; absent: `tool` is the only one, and has no joint */
  tools: v.optional(v.pipe(v.array(NamedTool), v.nonEmpty())),
  /** absent: no stones */
  stones: v.optional(v.array(Stone)),
  hand: v.object({ motion: v.string(), max_force_n: v.number(), max_torque_nm: v.number() }),
  workspace: Range3,
});
export type Scene = v.InferOutput<typeof Scene>;

/** Returns the number and radius of each particle size, in the order of a frame's particles. */
export function grainsOf(scene: Scene): { count: number; radius_m: number }[] {
  return scene.grains ?? [{ count: scene.particles, radius_m: scene.radius_m }];
}

/** Returns the radius of each particle, in m. */
export function radiiOf(scene: Scene): Float32Array {
  const radii = new Float32Array(scene.particles).fill(scene.radius_m);
  let first = 0;
  for (const { count, radius_m } of grainsOf(scene)) radii.fill(radius_m, first, (first += count));
  return radii;
}

/** 90 % interval: lower end, median, upper end */
const Interval = v.pipe(v.array(v.number()), v.length(3));

/** Site map of a robot: heights over its first surface, row by row along x; null: unknown. */
const Site = v.object({
  corner_m: v.pipe(v.array(v.number()), v.length(2)),
  cell_m: v.number(),
  columns: v.number(),
  rows: v.number(),
  heights_mm: v.array(v.nullable(v.number())),
});
export type Site = v.InferOutput<typeof Site>;

const Robot = v.object({
  state: v.string(),
  /** reason for its stop; null: not stopped */
  reason: v.nullable(v.string()),
  heard: v.boolean(),
  /** ticks since the newest command that the robot has confirmed */
  behind: v.number(),
  round_trip_s: v.number(),
  /** pose of its tool at that time */
  pose: v.pipe(v.array(v.number()), v.length(7)),
  /** soil forces of this bed and of the robot at the newest commands with both known */
  felt_n: Vec3,
  met_n: Vec3,
  /** soil parameters estimated from the robot's forces; null: none yet */
  learned: v.nullish(
    v.object({ friction_angle_deg: Interval, cohesion_pa: Interval, tool_friction_angle_deg: Interval }),
  ),
  /** null: no map received; absent from older programs */
  site: v.nullish(Site),
});
export type Robot = v.InferOutput<typeof Robot>;

const Status = v.object({
  type: v.literal('status'),
  time_s: v.number(),
  ticks: v.number(),
  misses: v.number(),
  /** number of `misses` because the tick's own work took too long, for example with too fine soil; absent from older
   * programs */
  misses_too_long: v.optional(v.number()),
  /** number of `misses` because the machine woke the loop's thread late */
  misses_woken_late: v.optional(v.number()),
  /** number of `misses` because the thread was preempted during the tick */
  misses_preempted: v.optional(v.number()),
  success_rate: v.number(),
  rate_hz: v.number(),
  tick_us: v.object({ p50: v.number(), p99: v.number(), max: v.number() }),
  particles: v.number(),
  awake: v.number(),
  paused: v.boolean(),
  speed: v.number(),
  held_by: v.nullable(v.number()),
  clients: v.number(),
  device: v.string(),
  /** Whether a person's hand is at the device: changes of the scene then need a confirmation. */
  person_feels: v.boolean(),
  /** Reason why the device currently renders no force. */
  let_go: v.nullable(v.string()),
  real_time: v.object({ scheduler: v.nullable(v.string()), memory_locked: v.boolean() }),
  simd: v.string(),
  threads: v.number(),
  busy: v.nullable(v.string()),
  problem: v.nullable(v.string()),
  can_undo: v.boolean(),
  undo: v.nullable(v.string()),
  /** an undo would restore the change that the last undo reverted; absent from older programs */
  undo_redoes: v.optional(v.boolean(), false),
  recording: v.nullable(v.string()),
  /** the last finished file, and its folder; absent from older programs */
  recorded: v.nullish(v.object({ file: v.string(), folder: v.string() })),
  /** a remote robot that follows the tool; absent from older programs */
  robot: v.nullish(Robot),
});
export type Status = v.InferOutput<typeof Status>;

const Reply = v.object({
  type: v.literal('reply'),
  /** null: the command had no valid id */
  id: v.nullable(v.number()),
  ok: v.boolean(),
  error: v.optional(v.string()),
});
export type Reply = v.InferOutput<typeof Reply>;

export type Message = Hello | Scene | Status | Reply | StudyMessage;

const MESSAGES = new Map<string, v.GenericSchema<unknown, Message>>([
  ['hello', Hello],
  ['scene', Scene],
  ['status', Status],
  ['reply', Reply],
  ['study', StudyMessage],
]);
const Head = v.object({ type: v.string(), protocol: v.optional(v.unknown()) });

/** Reads a JSON message; returns null for an unknown type, so that later programs may add types.
 * @throws ProtocolError: names the invalid key. */
export function decodeMessage(text: string): Message | null {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    throw new ProtocolError('a message is not JSON');
  }
  if (!v.is(Head, value)) throw new ProtocolError('a message has no type');
  const { type, protocol } = value;
  if (type === 'hello' && protocol !== PROTOCOL_VERSION)
    throw new ProtocolError(
      `the program speaks protocol ${String(protocol)}, this page ${PROTOCOL_VERSION}; reload the page`,
    );
  const schema = MESSAGES.get(type);
  if (!schema) return null;
  const read = v.safeParse(schema, value, { abortEarly: true });
  if (read.success) return read.output;
  const [{ path = [], received, expected, message }] = read.issues;
  const where = path.map(({ key }) => (typeof key === 'number' ? `[${key}]` : `.${String(key)}`)).join('');
  throw new ProtocolError(
    `${type}${where} ${received === 'undefined' ? 'is missing' : `is not valid: must be ${expected ?? message}`}`,
  );
}
