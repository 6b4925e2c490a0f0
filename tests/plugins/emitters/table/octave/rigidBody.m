% A body as the reference page of rigidBody describes it.
classdef rigidBody < handle
  properties
    Name = '';
    Joint = [];
    Parent = '';
    Mass = 1;
    CenterOfMass = [0 0 0];
    Inertia = [1 1 1 0 0 0];
  end
  methods
    function body = rigidBody(name)
      body.Name = name;
    end
  end
end
