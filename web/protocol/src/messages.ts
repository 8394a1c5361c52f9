// What the program tells: docs/reference/web-messages.md, version 1.
//
// Text is JSON. What the program says is described by the schemas below, which check each message and give the types;
// keys that they do not name are left out, so that later programs may add some.

import * as v from 'valibot';
import { Vec3 } from './pose.js';
import { ProtocolError } from './protocol_error.js';
import { Stone } from './stone.js';
import { StudyMessage } from './study.js';
import { ToolMesh } from './tool_mesh.js';
import { PROTOCOL_VERSION } from './version.js';

const Shape = v.picklist(['box', 'sphere', 'plate', 'cylinder', 'jaws', 'mesh']);
export type Shape = v.InferOutput<typeof Shape>;

const Hello = v.object({
  type: v.literal('hello'),
  protocol: v.literal(PROTOCOL_VERSION),
  version: v.string(),
  client: v.number(),
  /** pages may look on only */
  read_only: v.boolean(),
  /** a tool may be uploaded; an older program takes none, and does not say */
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
  frictions: v.array(v.string()),
  /** those that this page can draw */
  shapes: v.pipe(
    v.array(v.string()),
    v.transform((names) => names.filter((name): name is Shape => v.is(Shape, name))),
  ),
  manoeuvres: v.array(v.string()),
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

const Tool = v.pipe(
  v.object({
    shape: Shape,
    size_mm: Vec3,
    diameter_mm: v.number(),
    thickness_mm: v.number(),
    /** of a cylinder; an older program has none, and does not say */
    length_mm: v.optional(v.number(), 0),
    /** between jaws that are wide open */
    opening_mm: v.number(),
    /** of each jaw; an older program has flat ones, and does not say */
    jaw_bend_deg: v.optional(v.number(), 0),
    /** whatever the shape is now; null: nobody has drawn one */
    mesh: v.nullish(ToolMesh, null),
  }),
  v.forward(
    v.check(({ shape, mesh }) => shape !== 'mesh' || mesh !== null, 'there for a tool of this shape'),
    ['mesh'],
  ),
);
export type Tool = v.InferOutput<typeof Tool>;

/** Whether two tools are the same in every number; a mesh, which has too many of them, is the same only as itself. */
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
  /** of the coarsest grains */
  radius_m: v.number(),
  /** Whether `coarser` has coarser soil for it; programs before it do not send it. */
  can_coarsen: v.optional(v.boolean(), false),
  /** how many of which radius, in the order of a frame's particles; an older program has one size, and does not say */
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
  /** all null: a participant of a study is not told */
  soil: v.object({
    preset: v.nullable(v.string()),
    name: v.nullable(v.string()),
    friction: v.nullable(v.string()),
    friction_angle_deg: v.nullable(v.number()),
    cohesion_pa: v.nullable(v.number()),
    bulk_density_kg_m3: v.nullable(v.number()),
  }),
  sliders: v.array(Slider),
  body: v.nullable(v.string()),
  gravity_m_s2: Vec3,
  tool: Tool,
  /** left out: there are none */
  stones: v.optional(v.array(Stone)),
  hand: v.object({ manoeuvre: v.string(), max_force_n: v.number(), max_torque_nm: v.number() }),
  workspace: Range3,
});
export type Scene = v.InferOutput<typeof Scene>;

/** How many grains there are of which radius, in the order of a frame's particles. */
export function grainsOf(scene: Scene): { count: number; radius_m: number }[] {
  return scene.grains ?? [{ count: scene.particles, radius_m: scene.radius_m }];
}

/** Radius of each particle, in m. */
export function radiiOf(scene: Scene): Float32Array {
  const radii = new Float32Array(scene.particles).fill(scene.radius_m);
  let first = 0;
  for (const { count, radius_m } of grainsOf(scene)) radii.fill(radius_m, first, (first += count));
  return radii;
}

/** the lower end of 90 %, the middle, the upper end */
const Interval = v.pipe(v.array(v.number()), v.length(3));

/** What a robot sees of its site: heights over its first surface, row by row along x; null: not known. */
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
  /** why it stopped; null: it has not */
  reason: v.nullable(v.string()),
  heard: v.boolean(),
  /** ticks since the command that it was last heard to have come to */
  behind: v.number(),
  round_trip_s: v.number(),
  /** of its tool then */
  pose: v.pipe(v.array(v.number()), v.length(7)),
  /** at the newest commands of which both are known, and what the robot met there */
  felt_n: Vec3,
  met_n: Vec3,
  /** what the soil here has learned to be like from what the robot met; null: nothing yet */
  learned: v.nullish(
    v.object({ friction_angle_deg: Interval, cohesion_pa: Interval, tool_friction_angle_deg: Interval }),
  ),
  /** null: it has shown nothing; an older program does not say */
  site: v.nullish(Site),
});
export type Robot = v.InferOutput<typeof Robot>;

const Status = v.object({
  type: v.literal('status'),
  time_s: v.number(),
  ticks: v.number(),
  misses: v.number(),
  /** of `misses`: the tick's own work took too long, as with soil too fine for the machine; an older program does not say */
  misses_too_long: v.optional(v.number()),
  /** of `misses`: the machine woke the loop's thread late */
  misses_woken_late: v.optional(v.number()),
  /** of `misses`: the processor was taken away during the tick */
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
  /** A person's hand is at the device: what changes the scene has to be confirmed. */
  person_feels: v.boolean(),
  /** Why the hand at the device feels nothing just now. */
  let_go: v.nullable(v.string()),
  real_time: v.object({ scheduler: v.nullable(v.string()), memory_locked: v.boolean() }),
  simd: v.string(),
  threads: v.number(),
  busy: v.nullable(v.string()),
  problem: v.nullable(v.string()),
  can_undo: v.boolean(),
  undo: v.nullable(v.string()),
  /** an undo would bring back what the last one took back; an older program does not say */
  undo_redoes: v.optional(v.boolean(), false),
  recording: v.nullable(v.string()),
  /** the last file that is finished, and where it is; an older program does not say */
  recorded: v.nullish(v.object({ file: v.string(), folder: v.string() })),
  /** far away, follows the tool; an older program knows of none, and does not say */
  robot: v.nullish(Robot),
});
export type Status = v.InferOutput<typeof Status>;

const Reply = v.object({
  type: v.literal('reply'),
  /** null: that of the command was none */
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

/**
 * Reads a JSON message; a type that this page does not know is null, so that later programs may add some.
 * @throws ProtocolError: says which key is wrong.
 */
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
