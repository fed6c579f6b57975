/** Creates the page's parts and connects them. */
import { hashOfSession, hashWithLayer, layerOfHash, sessionOfHash } from './address';
import { ServerCharts } from './charts/server_charts';
import { Chooser } from './chooser';
import { byId } from './dom';
import { Keys } from './keys';
import { Camera } from './map/camera';
import type { Box } from './map/free_area';
import { createMap, MapView } from './map/map_view';
import { NewestSessions } from './newest_sessions';
import { Cursor } from './panel/cursor';
import { DisplayPanel } from './panel/display_panel';
import { EstimateButton } from './panel/estimate_button';
import { Facts } from './panel/facts';
import { LayersPanel } from './panel/layers_panel';
import { ModeButton } from './panel/mode_button';
import { ExploredNote } from './panel/explored_note';
import { Notice } from './panel/notice';
import { RobotList } from './panel/robot_list';
import { showScale } from './panel/scale_bar';
import { Status } from './panel/status';
import { SwipeHandle } from './panel/swipe_handle';
import { TimeBar } from './panel/time_bar';
import { Picture } from './picture';
import { SessionPanel } from './sessions/session_panel';
import { SettingsStore } from './settings';
import { SignIn } from './sign_in';
import { readTheme } from './theme';
import { SessionHistory } from './time/history';
import { addTools } from './tools/all_tools';
import type { ToolContext } from './tools/context';
import { locateCard } from './tools/locate';
import { Toolbox } from './tools/toolbox';
import { Comparison } from './tools/weave/comparison';
import { Viewer } from './viewer';
import './style/index.css';

const settings = new SettingsStore();
const keys = new Keys();
const panelToggle = byId('panel-toggle', HTMLButtonElement);
const target = byId('map', HTMLElement);
const map = createMap(target);
const mapView = new MapView(map, readTheme(), (error) => status.settle('tiles', error));
const picture = new Picture(mapView);
const notice = new Notice(byId('notice', HTMLElement));
const status = new Status(byId('status', HTMLElement));
/** Sessions that this page is deleting. */
const ending = new Set<string>();
const sessionPanel = new SessionPanel(readTheme(), {
  created: ({ name }) => void (location.hash = hashOfSession(name)),
  wanted: () => setPanel(true),
  deleting: (name) => void ending.add(name),
  notDeleted: (name) => void ending.delete(name),
  deleted: (name) => {
    chooser.leave(name);
    ending.delete(name);
  },
});
const serverCharts = new ServerCharts(byId('server-toggle', HTMLButtonElement), byId('server', HTMLElement));
const newest = new NewestSessions();
const robotList = new RobotList(
  byId('robots', HTMLElement),
  { pathLength: (robot) => viewer.pathLength(robot) },
  (robot) => (robot === null ? camera.free() : camera.follow(robot)),
  (robot, button) => {
    setPanel(false);
    toolbox.toggle(locateCard(toolContext, robot), button);
  },
);
const camera = new Camera(map, target, controlsOnMap, (robot) => robotList.setFollowed(robot));
const viewer: Viewer = new Viewer({
  map: mapView,
  picture,
  camera,
  cursor: new Cursor(map, target),
  facts: new Facts(byId('facts', HTMLElement), byId('moving-scans', HTMLElement)),
  mode: new ModeButton(byId('mode', HTMLElement), (isLocalizeOnly) => {
    if (viewer.session) viewer.refresh({ ...viewer.session, isLocalizeOnly });
  }),
  estimate: new EstimateButton(byId('estimate', HTMLElement), () => void chooser.refreshSoon()),
  robots: robotList,
  notice,
  explored: new ExploredNote(byId('explored', HTMLElement)),
  status,
  settings,
  details: byId('details', HTMLElement),
  noRobots: byId('no-robots', HTMLElement),
  newest: (session) => {
    const known = newest.learn(session);
    sessionPanel.refresh(known);
    return known;
  },
  refresh: () => void chooser.refreshSoon(),
  endIsExpected: (name) => ending.has(name),
});
const chooser = new Chooser({ viewer, panel: sessionPanel, notice, newest });
const toolContext: ToolContext = {
  ...{ map, target, picture, theme: readTheme },
  session: () => viewer.session,
  robots: () => viewer.robots,
};
const toolbox = new Toolbox(keys, () => viewer.session?.bounds != null, target);
/** Applies the current colours to all parts. */
let coloured = JSON.stringify(readTheme());
const comparison = new Comparison(picture);

function open(): void {
  const layer = layerOfHash(location.hash);
  if (layer !== null) picture.change({ layer });
  chooser.open();
}

/** The boxes of the controls that cover the map, in map pixels. */
function controlsOnMap(): Box[] {
  const origin = target.getBoundingClientRect();
  return [...document.querySelectorAll('.tools, .scale-bar')].map((element) => {
    const { left, top, right, bottom } = element.getBoundingClientRect();
    return { left: left - origin.left, top: top - origin.top, right: right - origin.left, bottom: bottom - origin.top };
  });
}

/** Relevant on phones only, where the panel covers most of the map. */
function setPanel(open: boolean): void {
  panelToggle.setAttribute('aria-expanded', String(open));
  byId('panel', HTMLElement).classList.toggle('open', open);
}

/** Updates the address without adding an entry to the browser's history for each layer. */
function rememberLayer(): void {
  const hash = hashWithLayer(location.hash, picture.now.layer);
  if (sessionOfHash(hash) !== null && hash !== location.hash) history.replaceState(null, '', hash);
}

/** Redraws everything that is drawn on canvases. */
function takeColours(): void {
  const theme = readTheme();
  if (JSON.stringify(theme) === coloured) return;
  coloured = JSON.stringify(theme);
  mapView.setTheme(theme);
  sessionPanel.setTheme(theme);
  serverCharts.takeColours();
  for (const layer of map.getLayers().getArray()) layer.changed();
}

function connectControls(): void {
  byId('zoom-in', HTMLButtonElement).addEventListener('click', () => camera.zoomBy(1));
  byId('zoom-out', HTMLButtonElement).addEventListener('click', () => camera.zoomBy(-1));
  byId('fit', HTMLButtonElement).addEventListener('click', () => camera.fit());
  panelToggle.addEventListener('click', () => setPanel(panelToggle.getAttribute('aria-expanded') !== 'true'));
}

function bindKeys(): void {
  const toggleCounters = (): void => settings.change({ counters: !settings.get().counters });
  keys.bind({ key: 'v', does: 'shows the next layer', run: () => picture.step(1) });
  keys.bind({ key: 'b', does: 'shows the previous layer', run: () => picture.step(-1) });
  keys.bind({ key: 'g', does: 'shows HIMM counters in the cells, when zoomed in', run: toggleCounters });
  keys.bind({ key: 'f', does: 'fits the map and follows its growth', run: () => camera.fit() });
  keys.bind({ key: '/', does: 'searches the sessions', run: () => sessionPanel.focusSearch() });
}

function buildPanels(): void {
  showScale(map, byId('scale', HTMLElement));
  new LayersPanel(picture, settings);
  new SwipeHandle(byId('swipe', HTMLElement), target, picture);
  new DisplayPanel(settings, keys);
  keys.enable(() => settings.get().keys);
  const past = new SessionHistory(viewer, picture);
  const timeBar = new TimeBar(byId('time-bar', HTMLElement), byId('history-open', HTMLButtonElement), past, keys);
  status.listen((isOffline) => timeBar.setOffline(isOffline));
}

function listen(): void {
  status.listen((isOffline) => {
    sessionPanel.setOffline(isOffline);
    robotList.setOffline(isOffline);
    mapView.setOffline(isOffline);
  });
  settings.listen(takeColours);
  picture.listen(rememberLayer);
  viewer.listen((session) => {
    if (session !== null) return;
    comparison.end();
    toolbox.close();
  });
  window.addEventListener('hashchange', () => {
    setPanel(false);
    open();
  });
}

connectControls();
bindKeys();
addTools(toolbox, toolContext, comparison, () => setPanel(false));
buildPanels();
listen();
notice.show({ kind: 'loading' });
void new SignIn(byId('sign-in', HTMLElement)).run();
open();
chooser.run((error) => {
  status.settle('sessions', error);
  sessionPanel.settle(error);
});
