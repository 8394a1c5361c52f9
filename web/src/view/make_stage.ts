import { h } from '../panels/html';
import { Stage, type StageOptions } from './stage';

/** A stage in `host`, or a sentence that says why there is none, and the error. */
export function makeStage(host: HTMLElement, options: StageOptions): Stage {
  try {
    return new Stage(host, options);
  } catch (error) {
    host.append(h('p', { class: 'no-picture' }, 'This browser does not show WebGL 2, which the picture needs.'));
    throw error;
  }
}
