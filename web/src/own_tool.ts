// The tool of this page: the first, unless the visitor has chosen another one. The rest of the page treats it as the
// only one.

import type { Frame, Scene } from 'haptolith-protocol';

/** Returns the scene with this tool as its `tool`. */
export function sceneOf(scene: Scene, own: number): Scene {
  const tool = scene.tools?.[own];
  return tool ? { ...scene, tool, hand: { ...scene.hand, motion: tool.motion } } : scene;
}

/** Returns the frame with this tool in its header. */
export function frameOf(frame: Frame, own: number): Frame {
  const tool = frame.tools[own];
  if (!tool) return frame;
  const { hub, wished, force_n, torque_nm, opening_m, held_by } = tool;
  const bands = frame.bands.slice(own, own + 1);
  return { ...frame, tool: hub, wished, force_n, torque_nm, opening_m, held: held_by !== 0, bands };
}

/** Name of this tool in commands; undefined: it is the only one. */
export function nameOf(scene: Scene, own: number): string | undefined {
  const tools = scene.tools ?? [];
  return tools.length > 1 ? tools[own]?.name : undefined;
}
