// Selects the page by its address.
//
//   bed_page.ts     the page with the bed and the tool
//   study/          the participant's and the experimenter's page of a study: `?study=participant`, `?study=experimenter`
//
// Parts of the pages:
//
//   ../protocol/    messages and commands of the program (docs/reference/web-protocol.md), and those of a study
//   connection.ts   connection to the program, which reconnects automatically; token.ts: access token for the program
//   view/           the picture: Stage contains all objects, one file each; shaders work in the scene's frame, in
//                   metres, so that a screen and a headset show the same
//   hand/           holding the tool: Hand sends the target pose, which mouse, keys, gamepad and controller move
//   panels/         numbers, plots and controls around the picture
//   automation.ts   window.haptolith, for tests and for pictures from the command line
//
// Messages flow one way: program -> connection -> stage and panels. Actions of the user go to the program as commands,
// and the page shows their effect when the program's next message confirms it.

import './style.css';
import './study/study.css';
import { openBedPage } from './bed_page';
import { ServedProgram, SILENCE_FOR_PICTURES_MS, socketAddress } from './connection';
import { readSettings } from './settings';
import { openExperimenterPage } from './study/experimenter_page';
import { openParticipantPage } from './study/participant_page';
import { takeToken } from './token';

const settings = readSettings(location.search, matchMedia('(prefers-color-scheme: light)').matches);

const program = new ServedProgram(
  socketAddress(
    location,
    takeToken(location, history, () => sessionStorage),
  ),
  settings.for_pictures ? SILENCE_FOR_PICTURES_MS : undefined,
);

if (settings.study === 'participant') openParticipantPage(settings, program);
else if (settings.study === 'experimenter') openExperimenterPage(settings, program);
else openBedPage(settings, program);
