% A tree as the reference page of rigidBodyTree describes it, of one chain: names are unique, parents come first.
classdef rigidBodyTree < handle
  properties
    BaseName = 'base';
    Bodies = {};
  end
  methods
    function tree = rigidBodyTree(key, value)
      if ~strcmp(key, 'DataFormat') || ~strcmp(value, 'row')
        error('DataFormat');
      end
    end
    function addBody(tree, body, parent)
      if isempty(tree.Bodies)
        last = tree.BaseName;
      else
        last = tree.Bodies{end}.Name;
      end
      if ~strcmp(parent, last)
        error('%s is no end of the chain', parent);
      end
      for number = 1:numel(tree.Bodies)
        if strcmp(tree.Bodies{number}.Name, body.Name) || strcmp(tree.Bodies{number}.Joint.Name, body.Joint.Name)
          error('%s is there already', body.Name);
        end
      end
      tree.Bodies{end + 1} = body;
    end
    function pose = getTransform(tree, q, name)
      pose = eye(4);
      used = 0;
      for number = 1:numel(tree.Bodies)
        joint = tree.Bodies{number}.Joint;
        value = 0;
        if ~strcmp(joint.Type, 'fixed')
          used = used + 1;
          value = q(used);
        end
        pose = pose * toParent(joint, value);
        if strcmp(tree.Bodies{number}.Name, name)
          return
        end
      end
      error('no body %s', name);
    end
  end
end
