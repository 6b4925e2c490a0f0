% A joint as the reference page of rigidBodyJoint describes it: parent <- motion <- child.
classdef rigidBodyJoint < handle
  properties
    Name = '';
    Type = 'fixed';
    JointAxis = [0 0 1];
    PositionLimits = [-pi pi];
    JointToParentTransform = eye(4);
    ChildToJointTransform = eye(4);
  end
  methods
    function joint = rigidBodyJoint(name, type)
      joint.Name = name;
      joint.Type = type;
    end
    function setFixedTransform(joint, numbers, notation)
      joint.JointToParentTransform = eye(4);
      joint.ChildToJointTransform = eye(4);
      if nargin < 3
        joint.JointToParentTransform = numbers;
        return
      end
      a = numbers(1); alpha = numbers(2); d = numbers(3); theta = numbers(4);
      if strcmp(joint.Type, 'revolute'), theta = 0; end
      if strcmp(joint.Type, 'prismatic'), d = 0; end
      x = [1 0 0 a; 0 cos(alpha) -sin(alpha) 0; 0 sin(alpha) cos(alpha) 0; 0 0 0 1];
      z = [cos(theta) -sin(theta) 0 0; sin(theta) cos(theta) 0 0; 0 0 1 d; 0 0 0 1];
      if strcmp(notation, 'dh')
        joint.ChildToJointTransform = z * x;
      elseif strcmp(notation, 'mdh')
        joint.JointToParentTransform = x * z;
      else
        error('notation %s', notation);
      end
    end
    function pose = toParent(joint, q)
      motion = eye(4);
      if strcmp(joint.Type, 'revolute')
        s = joint.JointAxis(3) * sin(q);
        motion = [cos(q) -s 0 0; s cos(q) 0 0; 0 0 1 0; 0 0 0 1];
      elseif strcmp(joint.Type, 'prismatic')
        motion(1:3, 4) = q * joint.JointAxis';
      end
      pose = joint.JointToParentTransform * motion * joint.ChildToJointTransform;
    end
  end
end
