/** Draws the robots' goals: the path, the place to stand, and the place to observe. */
import Feature from 'ol/Feature';
import LineString from 'ol/geom/LineString';
import PointGeometry from 'ol/geom/Point';
import VectorLayer from 'ol/layer/Vector';
import VectorSource from 'ol/source/Vector';
import Circle from 'ol/style/Circle';
import Fill from 'ol/style/Fill';
import RegularShape from 'ol/style/RegularShape';
import Stroke from 'ol/style/Stroke';
import Style from 'ol/style/Style';
import type { RobotGoal } from '../api/goals';
import type { RobotColours } from '../robot_colours';
import type { Theme } from '../theme';
import { kOrder } from './order';

type Role = 'path' | 'sight' | 'goal' | 'target';

export class GoalsLayer {
  private readonly source = new VectorSource();
  readonly layer = new VectorLayer({ source: this.source, zIndex: kOrder.paths });

  constructor(
    private readonly colours: RobotColours,
    theme: Theme,
  ) {
    this.setTheme(theme);
  }

  show(goals: RobotGoal[]): void {
    this.source.clear(true);
    this.source.addFeatures(goals.flatMap(featuresOf));
  }

  setTheme(theme: Theme): void {
    this.layer.setStyle((feature) => {
      const colour = theme.robots[this.colours.indexOf(feature.get('robot') as string)] ?? theme.ink;
      return stylesOf(feature.get('role') as Role, colour, theme.halo);
    });
  }
}

function featuresOf({ robot, path, goal, target }: RobotGoal): Feature[] {
  const features: Feature[] = [];
  const add = (role: Role, geometry: LineString | PointGeometry): void =>
    void features.push(new Feature({ geometry, role, robot }));
  if (path.length > 1) add('path', new LineString(path));
  if (goal && target) add('sight', new LineString([goal, target]));
  if (goal) add('goal', new PointGeometry(goal));
  if (target) add('target', new PointGeometry(target));
  return features;
}

function stylesOf(role: Role, colour: string, halo: string): Style[] {
  switch (role) {
    case 'path':
      return [
        new Style({ stroke: new Stroke({ color: halo, width: 5, lineJoin: 'round' }) }),
        new Style({ stroke: new Stroke({ color: colour, width: 2.5, lineDash: [8, 5], lineJoin: 'round' }) }),
      ];
    case 'sight':
      return [new Style({ stroke: new Stroke({ color: colour, width: 1, lineDash: [2, 4] }) })];
    case 'goal':
      return [
        new Style({
          image: new Circle({
            radius: 7,
            fill: new Fill({ color: halo }),
            stroke: new Stroke({ color: colour, width: 3 }),
          }),
        }),
      ];
    case 'target':
      return [
        new Style({
          image: new RegularShape({
            points: 4,
            radius: 6,
            radius2: 0,
            stroke: new Stroke({ color: colour, width: 2 }),
          }),
        }),
      ];
  }
}
