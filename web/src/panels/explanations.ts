// Explanations of each number and each control, one sentence each. Shown next to it (tooltip.ts) and read aloud with
// it.

export const EXPLAIN = {
  // the top strip
  time: 'Simulated time since the program started, in seconds.',
  rate: 'Ticks of the force loop during the last second, and how many are wanted.',
  in_time: 'Ticks of the last ten seconds that were finished within their millisecond.',
  missed:
    'Ticks of the last ten seconds that came late: because the tick took too long, because the loop was woken late, or because another program took the processor during the tick.',
  missed_all: 'Ticks that came late since the program started.',
  tick_p99: 'Of one hundred ticks, 99 take no longer than this; each has 1000 µs.',
  coarser: 'Makes a new bed of the same soil in coarser particles, which this machine computes in less time (J).',
  awake:
    'Particles that are computed in each step, of all; those in soil at rest are left out until something moves them.',
  body_shown: 'The body whose gravity acts on the soil.',
  soil_shown: "The soil in the box: P1 to P6 are the paper's presets, a name is a soil as it was measured.",
  device: 'What holds the tool: a haptic device, or the virtual hand of this program.',
  granted: 'The operating system runs the force loop before all other programs, so that they cannot delay it.',
  not_granted: 'The operating system gives the force loop no priority, so other programs can delay a step.',
  robot:
    'A robot far away that follows the tool, and how old the news of it is: more than the link takes where it was cut off or its machine is too slow. Its tool is the orange outline in the picture.',
  learned:
    'How strong the soil here has become, to do to the tool what the robot meets: friction angle and cohesion, each with the interval that holds it nine times in ten.',
  site: 'The soil that the robot digs in, as it sees it from above, and its tool: from where the bed itself is seen, so that the two can be compared. What was never seen is a hole.',
  met: "Force of the soil on the robot's tool, at the newest commands that it was heard to have carried out.",
  clients: 'Browsers and programs that are connected, and which of them holds the tool.',

  // over the picture
  force: 'Force of the soil on the hand; N stands for newton, the weight of 100 g on Earth is about 1 N.',
  torque: "Torque of the soil on the hand about the tool's origin, in millinewton metres.",
  depth: "How deep the tool's origin is below the level surface of the soil, or how high above it, in millimetres.",
  axes: 'Components along the axes: x points to the right in the front view, y away from the viewer, z up; positions count from the middle of the floor.',

  // the column at the side
  soil: "The soil in the box: P1 to P6 are the paper's presets with their friction coefficients, the others are measured soils with their friction angles; choosing one makes a new bed.",
  friction:
    'How friction between particles is computed; choosing another model makes a new bed. It is not the strength of the soil, which the sliders set.',
  facts: 'Friction angle and cohesion (left out where they are not known) and bulk density of this soil.',
  body: 'The body whose gravity acts: it changes while the soil lies there.',
  tool: 'The tool in the soil: it changes while the soil lies there.',
  manoeuvre: 'What the virtual hand does with the tool while nobody holds it.',
  still: 'Stops the virtual hand where it is (Y).',
  tool_file: 'A file of yours becomes the tool: STL, OBJ or glTF. It can be dropped on the page, too.',
  bring:
    'Lifts the tool and brings it over the middle of the bed, where it is in the picture; a shovel with its nose down, so that it digs (K).',
  tilt: 'How far the nose of the tool points down: 0° presses like a plate, 40° to 60° digs (W and S).',
  dig: 'The left button or one finger moves the tool wherever it is pressed in the picture, not only on the tool (G).',
  reset: 'The scene as it was started (R).',
  level: 'The same soil, its surface level again (L).',
  undo: 'Takes back the last new bed, with the body and tool it had; pressed again it brings that back (Ctrl+Z).',
  pause: 'Stops or resumes simulated time (Space).',
  step: 'While paused: computes one step of 1 ms (. on the keyboard; , for 100).',
  record: 'Writes every step to a file on the computer where the program runs (O).',
  speed: 'How fast simulated time passes: real time, or slow motion.',
  view: 'Where the bed is seen from (1, 2, 3, 4).',
  sound:
    'Noise as loud as the work that the tool does on the soil, and as high as fine grains pass by it; a stone knocks.',

  // ways to draw soil
  grains:
    'The soil as it would look: each particle stands for a handful of fine grains, in ground that goes on around the box (P).',
  balls: 'The particles as they are computed, each a ball of its true size, in a box that stands on the ground (P).',

  // colours
  plain: 'The colour of the soil of this body.',
  force_colour: "Each particle in the colour of its contact force: the sum of its neighbours' normal forces on it.",
  speed_colour: 'Each particle in the colour of its speed.',
  depth_colour: 'Each particle in the colour of its depth below the level surface.',
  sleep: 'Which particles are asleep: in soil at rest, and left out of the computation until something moves them.',

  // sliders, by key
  friction_angle_deg: 'Angle of internal friction of the soil, as a shear test shows it.',
  cohesion_pa: 'Cohesion of the soil: the shear stress it carries without any load on it, as a shear test shows it.',
  estimated_angle:
    'Angle of internal friction of the soil; away from the measured soil it is an estimate from simulated shear tests.',
  estimated_cohesion:
    'Cohesion of the soil, its strength without any load; away from the measured soil it is an estimate from simulated shear tests.',
  contact_friction:
    'Friction coefficient where two particles touch; no shear test says which friction angle of the soil that makes.',
  contact_cohesion_mn:
    'Force that holds two particles together where they touch; no shear test says which cohesion of the soil that makes.',
} as const;

/** Returns the explanation of a slider of a soil. */
export function sliderExplanation(key: string, friction: string): string | null {
  if (friction !== 'paper' && key === 'friction_angle_deg') return EXPLAIN.estimated_angle;
  if (friction !== 'paper' && key === 'cohesion_pa') return EXPLAIN.estimated_cohesion;
  return key in EXPLAIN ? EXPLAIN[key as keyof typeof EXPLAIN] : null;
}

/** Returns the name that the page shows for a friction model; the protocol uses older names. */
export function frictionModelName(word: string): string {
  return { paper: 'ICRA 2021 (drag against space)', contact: 'contact' }[word] ?? word;
}

export const DRAG_WARNING =
  'This model acts against space, not between particles: soil does not fall or weigh as it should.';
