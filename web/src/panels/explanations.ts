// Explanations of each number and each control, one sentence each. Shown next to it (tooltip.ts) and read aloud with
// it.

export const EXPLAIN = {
  // the top strip
  time: 'Simulated time since the program started, in seconds.',
  rate: 'Ticks of the force loop in the last second, and the target.',
  in_time: 'Ticks of the last ten seconds that finished within 1 ms.',
  missed:
    'Late ticks of the last ten seconds: the tick took too long, the loop was woken late, or another program used the CPU.',
  missed_all: 'Late ticks since the start of the program.',
  tick_p99: '99 % of ticks take at most this time; the limit is 1000 µs.',
  coarser: 'Makes a new bed of the same soil with coarser particles, which need less computing time (J).',
  awake:
    'Particles that are computed in each step, and their total; particles at rest sleep until something moves them.',
  body_shown: 'The body whose gravity acts on the soil.',
  soil_shown: 'The soil in the box: P1 to P6 are presets of the ICRA 2021 paper, names are measured soils.',
  device: 'Device that moves the tool: a haptic device, or the virtual hand of this program.',
  granted: 'The operating system runs the force loop before all other programs.',
  not_granted: 'The force loop has no real-time priority, so other programs can delay it.',
  robot:
    'A remote robot that follows the tool, and the age of its reports. The age exceeds the link delay after an outage or on a slow machine. Its tool is the orange outline in the view.',
  learned:
    'Friction angle and cohesion of the adaptive model, estimated from the forces of the robot, each with its 90 % interval.',
  site: "The soil at the robot's site, seen by its camera, and its tool, in the same view as the bed. Unseen parts are holes.",
  met: "Force of the soil on the robot's tool, at its last reported command.",
  clients: 'Browsers and programs that are connected, and which of them holds the tool.',

  // over the picture
  force: 'Force of the soil on the hand in newton; the weight of 100 g on Earth is about 1 N.',
  torque: "Torque of the soil on the hand about the tool's origin, in millinewton metres.",
  depth: "Depth of the tool's origin below the level surface of the soil, or its height above it, in millimetres.",
  axes: 'Components along the axes: x points to the right in the front view, y away from the viewer, z up; positions are relative to the centre of the floor.',

  // the column at the side
  soil: 'The soil in the box: P1 to P6 are presets of the ICRA 2021 paper with their friction coefficients, the others are measured soils with their friction angles. A new choice makes a new bed.',
  friction:
    'Model of friction between particles. A new choice makes a new bed. The sliders set the strength of the soil.',
  facts: 'Friction angle and cohesion (if known) and bulk density of this soil.',
  body: 'The body whose gravity acts. A change keeps the present soil.',
  tool: 'The tool. A change keeps the present soil.',
  motion: 'Motion of the virtual hand while no one holds the tool.',
  still: 'Stops the virtual hand where it is (Y).',
  tool_file: 'Use a mesh file as the tool: STL, OBJ or glTF. It can also be dropped on the page.',
  bring: 'Moves the tool above the centre of the bed; a shovel with its nose down, ready to dig (K).',
  tilt: 'Pitch of the tool, nose down: 0° presses like a plate, 40° to 60° digs (W and S).',
  dig: 'The left button or one finger moves the tool from anywhere in the view (G).',
  reset: 'Restarts the scene (R).',
  level: 'Levels the surface of the soil (L).',
  undo: 'Undoes the last new bed, with its body and tool; a second click redoes it (Ctrl+Z).',
  pause: 'Stops or resumes simulated time (Space).',
  step: 'While paused: computes one step of 1 ms (. on the keyboard; , for 100).',
  record: 'Records every step to a file on the computer that runs the program (O).',
  speed: 'Speed of simulated time: real time, or slow motion.',
  view: 'Direction of view (1, 2, 3, 4).',
  sound: 'Sound of digging: louder with more work on the soil, higher with faster particles; stones knock.',

  // ways to draw soil
  grains: 'Soil as fine grains, in ground that continues around the box (P).',
  balls: 'The simulated particles as spheres of their true size, in a box on the ground (P).',

  // colours
  plain: 'The colour of the soil of this body.',
  force_colour: 'Colour by contact force: the sum of the normal forces on each particle.',
  speed_colour: 'Colour by speed.',
  depth_colour: 'Colour by depth below the level surface.',
  sleep: 'Colour by sleep: sleeping particles are at rest and not computed until something moves them.',

  // sliders, by key
  friction_angle_deg: 'Angle of internal friction of the soil in a shear test.',
  cohesion_pa: 'Cohesion of the soil in a shear test: its shear strength without load.',
  estimated_angle:
    'Angle of internal friction of the soil; estimated from simulated shear tests, except for the measured soil.',
  estimated_cohesion:
    'Cohesion of the soil, its strength without load; estimated from simulated shear tests, except for the measured soil.',
  contact_friction:
    'Friction coefficient between two particles. The friction angle of the soil is not known from a shear test.',
  contact_cohesion_mn: 'Tensile force between two particles. The cohesion of the soil is not known from a shear test.',
} as const;

/** Returns the explanation of a slider of a soil. */
export function sliderExplanation(key: string, friction: string): string | null {
  if (friction !== 'icra2021' && key === 'friction_angle_deg') return EXPLAIN.estimated_angle;
  if (friction !== 'icra2021' && key === 'cohesion_pa') return EXPLAIN.estimated_cohesion;
  return key in EXPLAIN ? EXPLAIN[key as keyof typeof EXPLAIN] : null;
}

/** Returns the name that the page shows for a friction model. */
export function frictionModelName(word: string): string {
  return { icra2021: 'ICRA 2021 (drag against space)', contact: 'contact' }[word] ?? word;
}

export const DRAG_WARNING =
  'This model acts against absolute space, not between particles: the fall and weight of soil are wrong.';
