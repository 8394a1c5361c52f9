// Positions and poses in the scene's frame.

import * as v from 'valibot';

export const Vec3 = v.tuple([v.number(), v.number(), v.number()]);
export type Vec3 = v.InferOutput<typeof Vec3>;
/** w, x, y, z */
export type Quat = [number, number, number, number];

export interface Pose {
  position_m: Vec3;
  rotation: Quat;
}
